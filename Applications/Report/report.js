// The behaviour of crease's reports: tabs, theme, viewers on stacks of pixels, curves, tables. It draws what
// the page's data say and keeps no state but the theme.
(() => {
  'use strict';

  const SVG = 'http://www.w3.org/2000/svg';
  const byId = (id) => document.getElementById(id);
  const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
  const data = JSON.parse(byId('report-data').textContent);
  const still = matchMedia('(prefers-reduced-motion: reduce)').matches;

  const fill = (node, attributes, children) => {
    for (const [name, value] of Object.entries(attributes || {})) {
      if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
      else if (value !== false && value != null) node.setAttribute(name, value === true ? '' : value);
    }
    node.append(...children.flat().filter((child) => child != null));
    return node;
  };
  const make = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
  const draw = (tag, attributes, ...children) => fill(document.createElementNS(SVG, tag), attributes, children);

  const shorten = (value, digits = 4) => {
    if (value === 0) return '0';
    const size = Math.abs(value);
    if (size >= 1e5 || size < 1e-3) return value.toExponential(digits - 2).replace('-', '\u2212').replace('e', ' e');
    return String(Number(value.toPrecision(digits))).replace('-', '\u2212');
  };

  /// Minus signs in place of hyphens before numbers.
  const signs = (text) => text.replace(/(^|[\s(])-(?=[\d.])/g, '$1\u2212');

  // ---- theme: what the system wants, unless one is chosen

  const dark = matchMedia('(prefers-color-scheme: dark)');
  const remembered = {
    get: () => { try { return localStorage.getItem('crease-theme'); } catch { return null; } },
    set: (value) => { try { localStorage.setItem('crease-theme', value); } catch { /* a page from a disk */ } },
  };
  let theme = ['light', 'dark'].includes(remembered.get()) ? remembered.get() : 'auto';
  const showTheme = () => {
    const shown = theme === 'auto' ? (dark.matches ? 'dark' : 'light') : theme;
    document.documentElement.dataset.theme = shown;
    byId('theme').textContent = `Theme: ${theme}`;
  };
  byId('theme').hidden = false;
  byId('theme').addEventListener('click', () => {
    theme = { auto: 'light', light: 'dark', dark: 'auto' }[theme];
    remembered.set(theme);
    showTheme();
  });
  dark.addEventListener('change', showTheme);
  showTheme();

  // ---- tabs

  const tabs = [...document.querySelectorAll('[role=tab]')];
  const panels = tabs.map((tab) => byId(tab.getAttribute('aria-controls')));
  const whenShown = new Map(panels.map((panel) => [panel, []]));
  const wake = (panel) => {
    for (const start of whenShown.get(panel).splice(0)) start();
  };
  const select = (chosen, focus) => {
    tabs.forEach((tab, i) => {
      const on = i === chosen;
      tab.setAttribute('aria-selected', on);
      tab.tabIndex = on ? 0 : -1;
      panels[i].hidden = !on;
    });
    if (focus) tabs[chosen].focus();
    tabs[chosen].scrollIntoView({ block: 'nearest', inline: 'nearest' });
    wake(panels[chosen]);
    if (focus) { try { history.replaceState(null, '', `#${panels[chosen].id}`); } catch { /* only an address */ } }
  };
  const fromAddress = () => Math.max(0, panels.findIndex((panel) => `#${panel.id}` === location.hash));
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => select(i, true));
    tab.addEventListener('keydown', (event) => {
      const to = { ArrowRight: i + 1, ArrowLeft: i - 1, Home: 0, End: tabs.length - 1 }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      select((to + tabs.length) % tabs.length, true);
    });
  });
  for (const panel of panels) {
    panel.setAttribute('role', 'tabpanel');
    panel.tabIndex = -1;
  }
  addEventListener('hashchange', () => select(fromAddress(), false));
  addEventListener('beforeprint', () => panels.forEach(wake));

  // ---- stacks of pixels

  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

  /// The colour of each byte as red, green, blue, alpha; contrast stretches about the middle.
  const coloursOf = (layer, contrast) => {
    const stops = layer.colours.map(rgb);
    const table = new Uint8ClampedArray(4 * 256);
    for (let byte = layer.first; byte < 256; ++byte) {
      const position = (byte - layer.first) / (255 - layer.first);
      const x = clamp(0.5 + (position - 0.5) * contrast, 0, 1) * (stops.length - 1);
      const k = Math.min(Math.floor(x), stops.length - 2);
      for (let c = 0; c < 3; ++c) table[4 * byte + c] = stops[k][c] + (x - k) * (stops[k + 1][c] - stops[k][c]);
      table[4 * byte + 3] = 255;
    }
    if (layer.first === 2) table.set([...rgb(layer.specialColour), 255], 4);
    return table;
  };

  const valueText = (layer, byte) => {
    if (byte === 0) return 'no value';
    if (byte < layer.first) return layer.special;
    const t = (byte - layer.first) / (255 - layer.first);
    const value = layer.logarithmic ? layer.lower * (layer.upper / layer.lower) ** t
      : layer.lower + t * (layer.upper - layer.lower);
    const beyond = byte === 255 ? '\u2265 ' : byte === layer.first && layer.lower !== 0 ? '\u2264 ' : '';
    return beyond + shorten(value, 3);
  };

  class Stack {
    constructor(description, number) {
      Object.assign(this, description);
      this.number = number;
      this.plane = 0;
      this.slice = this.planes.map((plane) => plane.slices.length >> 1);
      this.pictures = new Map();
      this.watchers = [];
    }
    shown() { return this.planes[this.plane]; }
    go(plane, slice) {
      this.plane = plane;
      this.slice[plane] = clamp(slice, 0, this.planes[plane].slices.length - 1);
      this.watchers.forEach((watcher) => watcher());
    }
    picture(layer) {
      const key = `pixels-${this.number}-${layer}-${this.plane}`;
      if (!this.pictures.has(key)) {
        const image = new Image();
        image.src = `data:image/png;base64,${byId(key).textContent}`;
        this.pictures.set(key, image.decode().then(() => image));
      }
      return this.pictures.get(key);
    }
    /// The bytes of a layer in the slice shown.
    async bytes(layer) {
      const { width, height } = this.shown();
      const slice = this.slice[this.plane];
      const image = await this.picture(layer);
      const canvas = make('canvas', { width, height });
      const context = canvas.getContext('2d', { willReadFrequently: true });
      context.drawImage(image, 0, slice * height, width, height, 0, 0, width, height);
      const pixels = context.getImageData(0, 0, width, height).data;
      const bytes = new Uint8Array(width * height);
      for (let n = 0; n < bytes.length; ++n) bytes[n] = pixels[4 * n];
      return bytes;
    }
    /// Of a pixel of the slice shown, in mm.
    point(x, y) {
      const plane = this.shown();
      return plane.slices[this.slice[this.plane]].origin.map((o, a) => o + x * plane.right[a] + y * plane.down[a]);
    }
  }
  const stacks = data.stacks.map((stack, number) => new Stack(stack, number));

  // ---- what viewers have in common

  /// One picture: a sheet of canvases under drawings, in a box that scrolls when it is enlarged.
  class Sheet {
    constructor(stack, count, label) {
      this.stack = stack;
      this.canvases = Array.from({ length: count }, () => make('canvas', {}));
      this.svg = draw('svg', { preserveAspectRatio: 'none', 'aria-hidden': 'true' });
      this.sheet = make('div', { class: 'sheet' }, this.canvases, this.svg);
      this.box = make('div', { class: 'stage', tabindex: 0, role: 'group', 'aria-label': label }, this.sheet);
      this.frame = make('div', { class: 'frame' }, this.box);
      this.cell = make('div', {}, this.frame);
      this.bytes = [];
      this.zoom = 1;
    }
    layOut() {
      const { widthMm, heightMm } = this.stack.shown();
      const room = this.cell.clientWidth - 2;
      const tallest = Math.max(280, innerHeight - 230);
      const fit = Math.min(room, tallest * widthMm / heightMm);
      this.frame.style.width = `${Math.min(room, fit * this.zoom) + 2}px`;
      this.sheet.style.width = `${fit * this.zoom}px`;
      this.sheet.style.height = `${fit * this.zoom * heightMm / widthMm}px`;
      this.box.style.maxHeight = `${Math.ceil(tallest) + 2}px`;
      this.unit = this.stack.shown().width / (fit * this.zoom);
      this.svg.style.setProperty('--unit', this.unit);
      this.svg.style.setProperty('--squash', (this.stack.shown().height / this.stack.shown().width) * (widthMm / heightMm));
    }
    async paint(at, layer, contrast = 1) {
      const ticket = this[`ticket${at}`] = Symbol();
      const bytes = await this.stack.bytes(layer);
      if (this[`ticket${at}`] !== ticket) return;  // another slice was asked for meanwhile
      const { width, height } = this.stack.shown();
      const canvas = this.canvases[at];
      canvas.width = width;
      canvas.height = height;
      const colours = coloursOf(this.stack.layers[layer], contrast);
      const pixels = new ImageData(width, height);
      const words = new Uint32Array(pixels.data.buffer), table = new Uint32Array(colours.buffer);
      for (let n = 0; n < bytes.length; ++n) words[n] = table[bytes[n]];
      canvas.getContext('2d').putImageData(pixels, 0, 0);
      this.bytes[at] = { layer, bytes, width };
    }
    overlay(shown) {
      const { width, height } = this.stack.shown();
      this.svg.setAttribute('viewBox', `-0.5 -0.5 ${width} ${height}`);
      this.svg.replaceChildren(...shown.map((number) => this.drawing(this.stack.overlays[number])));
    }
    drawing(overlay) {
      const { path, marks } = overlay.planes[this.stack.plane][this.stack.slice[this.stack.plane]];
      const line = (d, kind) => draw('path', { d, class: kind, 'vector-effect': 'non-scaling-stroke' });
      const group = draw('g', {});
      if (path) group.append(line(path, 'halo'), line(path, `line-${overlay.look}`));
      for (const [x, y, ring, label] of marks) {
        const shape = ring ? 'M7 0A7 7 0 1 1 -7 0A7 7 0 1 1 7 0' : 'M-5 -5L5 5M-5 5L5 -5';
        const mark = draw('g', { style: `transform: translate(${x}px, ${y}px) scale(var(--unit), calc(var(--unit) * var(--squash)))` },
          draw('path', { d: shape, class: 'under' }), draw('path', { d: shape, class: `line-${overlay.look}` }));
        if (label) mark.append(draw('text', { x: 9, y: -6, class: 'mark-text' }, label));
        group.append(mark);
      }
      return group;
    }
    /// The pixel under a pointer, or none.
    pixel(event) {
      const box = this.sheet.getBoundingClientRect();
      const { width, height } = this.stack.shown();
      const x = Math.floor((event.clientX - box.left) / box.width * width);
      const y = Math.floor((event.clientY - box.top) / box.height * height);
      return x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
    }
    valuesAt(x, y) {
      return this.bytes.filter(Boolean).map(({ layer, bytes, width }) => {
        const about = this.stack.layers[layer];
        return `${about.name.split(':')[0]} ${valueText(about, bytes[y * width + x])}`;
      });
    }
  }

  const range = (label, attributes, show, change) => {
    const output = make('output', {}, show(attributes.value));
    const input = make('input', { type: 'range', ...attributes, 'aria-label': label });
    const node = make('label', { class: 'range' }, make('span', { class: 'word' }, label), input, output);
    node.set = (value) => {
      input.value = value;
      output.textContent = show(Number(input.value));
    };
    node.get = () => Number(input.value);
    input.addEventListener('input', () => {
      node.set(input.value);
      change(node.get());
    });
    return node;
  };

  const lineSample = (look) => draw('svg', { class: 'key', viewBox: '0 0 26 14', 'aria-hidden': 'true' },
    look === 'landmark' ? draw('path', { d: 'M8 2L18 12M8 12L18 2', class: 'line-landmark' })
      : look === 'place' ? [draw('circle', { cx: 13, cy: 7, r: 5, class: 'under' }), draw('circle', { cx: 13, cy: 7, r: 5, class: 'line-place' })]
        : draw('path', { d: look === 'grid' ? 'M1 4.5H25M1 9.5H25M8 0V14M18 0V14' : 'M1 7H25', class: `line-${look}` }));

  const colourBar = (layer, contrast) => {
    const middle = 0.5;
    const stretched = layer.colours.map((colour, i) => {
      const position = middle + (i / (layer.colours.length - 1) - middle) / contrast;
      return `${colour} ${(100 * position).toFixed(2)}%`;
    });
    const names = make('div', { class: 'names' }, make('span', {}, layer.label));
    if (layer.special) names.append(make('span', {}, make('span', { class: 'swatch', style: `background:${layer.specialColour}` }), layer.special));
    names.append(make('span', {}, make('span', { class: 'swatch none' }), 'no value'));
    return make('div', { class: 'colours' },
      make('div', { class: 'strip', style: `background:linear-gradient(90deg, ${stretched.join(', ')})` }),
      make('div', { class: 'ticks', 'aria-hidden': 'true' },
        layer.ticks.map(([position, text]) => make('span', { style: `left:${100 * position}%` }, text.replace('-', '\u2212')))),
      names);
  };

  /// Controls and manners that all viewers share: planes, slices, zoom, drawings, readout, keys.
  class Viewer {
    constructor(figure, about) {
      this.figure = figure;
      this.about = about;
      this.stack = stacks[about.stack];
      this.overlays = new Set(about.overlays);
      this.bar = make('div', { class: 'bar' });
      this.more = make('div', { class: 'bar' });
      this.readout = make('p', { class: 'readout' }, '\u00a0');
    }
    /// When everything is there.
    start() {
      this.addSlices();
      this.addZoom();
      this.addOverlays();
      for (const sheet of this.sheets) {
        sheet.box.addEventListener('keydown', (event) => this.key(event));
        sheet.sheet.addEventListener('pointermove', (event) => this.tell(sheet, event));
        sheet.sheet.addEventListener('pointerleave', () => { this.readout.textContent = '\u00a0'; });
        sheet.box.addEventListener('scroll', () => this.scrollAlong(sheet));
      }
      this.stack.watchers.push(() => this.refresh());
      new ResizeObserver(() => this.layOut()).observe(this.figure);
      this.refresh();
    }
    layOut() {
      for (const sheet of this.sheets) sheet.layOut();
    }
    scrollAlong(from) {
      for (const sheet of this.sheets) {
        if (sheet === from) continue;
        sheet.box.scrollLeft = from.box.scrollLeft;
        sheet.box.scrollTop = from.box.scrollTop;
      }
    }
    addSlices() {
      const { stack } = this;
      if (stack.planes.length > 1) {
        const name = `plane-${this.figure.dataset.viewer}`;
        this.planeInputs = stack.planes.map((plane, p) => make('input', {
          type: 'radio', name, checked: p === stack.plane, onchange: () => stack.go(p, stack.slice[p]) }));
        this.bar.append(make('div', { class: 'modes', role: 'radiogroup', 'aria-label': 'Plane' },
          stack.planes.map((plane, p) => make('label', {}, this.planeInputs[p], make('span', {}, plane.name)))));
      }
      if (!stack.planes.some((plane) => plane.slices.length > 1)) return;
      this.sliceInput = range('Slice', { min: 0, max: 1, value: 0 }, (s) => stack.shown().slices[s]?.label ?? '',
        (s) => stack.go(stack.plane, s));
      this.bar.append(this.sliceInput);
    }
    addZoom() {
      this.zoom = range('Zoom', { min: 1, max: 8, step: 0.5, value: 1 }, (z) => `${z}\u00d7`, (z) => {
        const shares = this.sheets.map(({ box }) => [(box.scrollLeft + box.clientWidth / 2) / box.scrollWidth,
          (box.scrollTop + box.clientHeight / 2) / box.scrollHeight]);
        this.sheets.forEach((sheet, i) => {
          sheet.zoom = z;
          sheet.layOut();
          sheet.box.scrollLeft = shares[i][0] * sheet.box.scrollWidth - sheet.box.clientWidth / 2;
          sheet.box.scrollTop = shares[i][1] * sheet.box.scrollHeight - sheet.box.clientHeight / 2;
        });
      });
      this.more.append(this.zoom, make('label', {}, make('input', { type: 'checkbox',
        onchange: (event) => this.figure.classList.toggle('sharp', event.target.checked) }), 'show pixels'));
    }
    addOverlays() {
      for (const number of [...this.about.overlays, ...this.about.moreOverlays]) {
        const { name, look } = this.stack.overlays[number];
        this.more.append(make('label', {}, make('input', { type: 'checkbox', checked: this.overlays.has(number),
          onchange: (event) => {
            this.overlays[event.target.checked ? 'add' : 'delete'](number);
            this.drawOverlays();
          } }), lineSample(look), name));
      }
    }
    drawOverlays() {
      for (const sheet of this.sheets) sheet.overlay([...this.overlays]);
    }
    refresh() {
      const { stack } = this;
      this.planeInputs?.forEach((input, p) => { input.checked = p === stack.plane; });
      if (this.sliceInput) {
        this.sliceInput.querySelector('input').max = stack.shown().slices.length - 1;
        this.sliceInput.set(stack.slice[stack.plane]);
      }
      this.layOut();
      this.drawOverlays();
      this.painted = this.paint();
    }
    tell(sheet, event) {
      const pixel = sheet.pixel(event);
      if (!pixel) return;
      const [x, y] = pixel;
      const values = [...new Set(this.sheets.flatMap((each) => each.valuesAt(x, y)))];
      const point = this.stack.point(x, y).map((c) => c.toFixed(1).replace('-', '\u2212')).join(', ');
      this.readout.textContent = `(${point}) mm   ${values.join('   ')}`;
    }
    key(event) {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const { stack } = this;
      const slice = stack.slice[stack.plane];
      const actions = {
        PageUp: () => stack.go(stack.plane, slice - 1),
        PageDown: () => stack.go(stack.plane, slice + 1),
        '+': () => this.zoomBy(1),
        '-': () => this.zoomBy(-1),
        ...this.keys,
      };
      if (!actions[event.key]) return;
      event.preventDefault();
      actions[event.key](event);
    }
    zoomBy(step) {
      this.zoom.set(this.zoom.get() + step);
      this.zoom.querySelector('input').dispatchEvent(new Event('input'));
    }
    help(texts) {
      const all = texts.concat(this.stack.planes.some((plane) => plane.slices.length > 1) ? [['PageUp PageDown', 'slices']] : [],
        [['+ \u2212', 'zoom']]);
      return make('p', { class: 'keys' }, 'With the picture in focus: ',
        all.flatMap(([keys, what], i) => [i ? ', ' : '', ...keys.split(' ').flatMap((key) => [make('kbd', {}, key), ' ']), what]), '.');
    }
  }

  // ---- comparison: two layers, four ways

  class Compare extends Viewer {
    constructor(figure, about) {
      super(figure, about);
      this.layers = about.layers.slice(0, 2);
      this.mode = 'swipe';
      this.front = false;  // of flicker: whether the second layer shows
      const sheet = new Sheet(this.stack, 2, `${about.title}. Arrow keys move the divider, space flickers.`);
      this.sheets = [sheet];
      this.divider = make('div', { class: 'divider' });
      this.chips = [make('span', { class: 'chip left' }), make('span', { class: 'chip right' })];
      sheet.sheet.append(this.divider, ...this.chips);
      this.addModes();
      this.addLayers();
      this.addDragging(sheet);
      this.keys = {
        ArrowLeft: (event) => this.move(event.shiftKey ? -10 : -1),
        ArrowRight: (event) => this.move(event.shiftKey ? 10 : 1),
        ' ': () => { this.choose('flicker'); this.stop(); this.flip(); },
        ...Object.fromEntries(Object.keys(this.modes).map((mode, i) => [String(i + 1), () => this.choose(mode)])),
      };
      figure.append(this.bar, this.more, make('div', { class: 'stages single' }, sheet.cell), this.readout,
        this.help([['\u2190 \u2192', 'divider'], ['Space', 'flicker by hand'], ['1 2 3 4', 'the four ways']]));
      if (this.stack.note) figure.append(make('p', { class: 'note' }, this.stack.note));
      this.start();
    }
    addModes() {
      const percent = (value) => `${Math.round(value)} %`;
      this.modes = {
        swipe: range('Divider', { min: 0, max: 100, step: 0.5, value: 50 }, percent, () => this.show()),
        flicker: range('Every', { min: 0.1, max: 2, step: 0.1, value: 0.6 }, (s) => `${Number(s).toFixed(1)} s`, () => this.restart()),
        blend: range('Share', { min: 0, max: 100, value: 50 }, percent, () => this.show()),
        checkerboard: range('Tiles', { min: 2, max: 24, value: 8 }, (n) => `${n} across`, () => this.paint()),
      };
      this.auto = make('input', { type: 'checkbox', checked: !still, onchange: () => this.restart() });
      this.autoLabel = make('label', {}, this.auto, 'automatic');
      this.modeInputs = Object.keys(this.modes).map((mode) => make('input', { type: 'radio',
        name: `mode-${this.figure.dataset.viewer}`, value: mode, checked: mode === this.mode, onchange: () => this.choose(mode) }));
      this.bar.append(make('div', { class: 'modes', role: 'radiogroup', 'aria-label': 'Way to compare' },
        this.modeInputs.map((input) => make('label', {}, input, make('span', {}, input.value[0].toUpperCase() + input.value.slice(1))))),
      ...Object.values(this.modes), this.autoLabel);
    }
    addLayers() {
      const options = () => this.about.layers.map((layer) => make('option', { value: layer }, this.stack.layers[layer].name));
      this.selects = [0, 1].map((side) => {
        const select = make('select', { onchange: () => { this.layers[side] = Number(select.value); this.paint(); } }, options());
        return select;
      });
      this.more.append(make('label', {}, make('span', { class: 'word' }, 'First'), this.selects[0]),
        make('label', {}, make('span', { class: 'word' }, 'Second'), this.selects[1]));
    }
    addDragging(sheet) {
      const to = (event) => {
        const box = sheet.sheet.getBoundingClientRect();
        this.modes.swipe.set(100 * (event.clientX - box.left) / box.width);
        this.show();
      };
      sheet.sheet.addEventListener('pointerdown', (event) => {
        if (this.mode !== 'swipe' || event.button !== 0) return;
        sheet.sheet.setPointerCapture(event.pointerId);
        to(event);
      });
      sheet.sheet.addEventListener('pointermove', (event) => {
        if (this.mode === 'swipe' && sheet.sheet.hasPointerCapture(event.pointerId)) to(event);
      });
    }
    move(step) {
      if (this.mode === 'flicker') return;
      const control = this.modes[this.mode];
      control.set(control.get() + step);
      if (this.mode === 'checkerboard') this.paint(); else this.show();
    }
    choose(mode) {
      if (this.mode === mode) return;
      this.mode = mode;
      this.modeInputs.forEach((input) => { input.checked = input.value === mode; });
      this.paint();
      this.restart();
    }
    stop() {
      this.auto.checked = false;
      clearInterval(this.timer);
    }
    restart() {
      clearInterval(this.timer);
      if (this.mode === 'flicker' && this.auto.checked) {
        this.timer = setInterval(() => { if (this.figure.offsetParent) this.flip(); }, 1000 * this.modes.flicker.get());
      }
      this.show();
    }
    flip() {
      this.front = !this.front;
      this.show();
    }
    async paint() {
      this.selects.forEach((select, side) => { select.value = this.layers[side]; });
      const [sheet] = this.sheets;
      await Promise.all(this.layers.map((layer, side) => sheet.paint(side, layer)));
      if (this.mode === 'checkerboard') this.layTiles(...sheet.canvases);
      this.show();
    }
    /// Puts every other tile of the upper canvas into the lower one. (Two canvases with holes would show seams.)
    layTiles(below, above) {
      const { width, height, widthMm, heightMm } = this.stack.shown();
      const side = Math.max(widthMm, heightMm) / this.modes.checkerboard.get();
      const [dx, dy] = [side * width / widthMm, side * height / heightMm];
      const context = below.getContext('2d');
      for (let j = 0; j * dy < height; ++j) {
        for (let i = (j + 1) % 2; i * dx < width; i += 2) {
          const [x, y] = [Math.round(i * dx), Math.round(j * dy)];
          const tile = [x, y, Math.round((i + 1) * dx) - x, Math.round((j + 1) * dy) - y];
          context.clearRect(...tile);
          context.drawImage(above, ...tile, ...tile);
        }
      }
    }
    show() {
      const [sheet] = this.sheets;
      const [below, above] = sheet.canvases;
      const is = (mode) => this.mode === mode;
      const at = this.modes.swipe.get();
      for (const [mode, control] of Object.entries(this.modes)) control.hidden = !is(mode);
      this.autoLabel.hidden = !is('flicker');
      sheet.sheet.classList.toggle('swipes', is('swipe'));
      this.divider.hidden = !is('swipe');
      this.divider.style.left = `${at}%`;
      // Where the second layer has no value, the first must not show through.
      below.style.visibility = is('flicker') && this.front ? 'hidden' : 'visible';
      below.style.clipPath = is('swipe') ? `inset(0 ${100 - at}% 0 0)` : '';
      above.style.visibility = is('checkerboard') || (is('flicker') && !this.front) ? 'hidden' : 'visible';
      above.style.clipPath = is('swipe') ? `inset(0 0 0 ${at}%)` : '';
      above.style.opacity = is('blend') ? this.modes.blend.get() / 100 : 1;
      const names = this.layers.map((layer) => this.stack.layers[layer].name);
      const share = this.modes.blend.get();
      this.chips[0].textContent = {
        swipe: names[0],
        flicker: names[this.front ? 1 : 0],
        blend: `${100 - share} % ${names[0]}, ${share} % ${names[1]}`,
        checkerboard: `${names[0]} and ${names[1]} in turn`,
      }[this.mode];
      this.chips[1].textContent = names[1];
      this.chips[1].hidden = !is('swipe');
      this.chips[0].classList.toggle('alone', !is('swipe'));
    }
  }

  // ---- maps: layers side by side, with colour bars

  class Maps extends Viewer {
    constructor(figure, about) {
      super(figure, about);
      this.contrast = 1;
      this.sheets = about.layers.map((layer) => new Sheet(this.stack, 1, `${about.title}: ${this.stack.layers[layer].name}`));
      this.keys = {};
      if (about.contrast) {
        this.more.append(range('Contrast', { min: 1, max: 10, step: 0.5, value: 1 }, (c) => `${c}\u00d7`, (c) => {
          this.contrast = c;
          this.paint();
        }));
      }
      this.bars = about.layers.map(() => make('div', {}));
      const stages = make('div', { class: about.layers.length > 1 ? 'stages' : 'stages single' },
        this.sheets.map(({ cell, frame, box }, i) => {
          if (about.layers.length > 1) box.before(make('p', { class: 'panel-title' }, this.stack.layers[about.layers[i]].name));
          frame.append(this.bars[i]);
          return cell;
        }));
      figure.append(this.bar, this.more, stages, this.readout);
      this.addPlaces();
      figure.append(this.help([]));
      if (this.stack.note) figure.append(make('p', { class: 'note' }, this.stack.note));
      this.start();
      if (!this.bar.children.length) this.bar.remove();
    }
    addPlaces() {
      const { stack } = this;
      if (!this.about.places.length) return;
      const several = stack.planes.some((plane) => plane.slices.length > 1);
      this.figure.append(make('ul', { class: 'places', 'aria-label': 'Extreme places' }, this.about.places.map(({ text, slices }) =>
        make('li', {}, several ? make('button', { type: 'button', onclick: () => {
          slices.forEach((slice, plane) => { stack.slice[plane] = slice; });
          stack.go(stack.plane, slices[stack.plane]);
        } }, signs(text)) : signs(text)))));
    }
    async paint() {
      this.about.layers.forEach((layer, i) => {
        this.bars[i].replaceChildren(colourBar(this.stack.layers[layer], this.contrast));
      });
      await Promise.all(this.about.layers.map((layer, i) => this.sheets[i].paint(0, layer, this.contrast)));
    }
  }

  // ---- curves

  const dashes = ['', '', '7 4', '2 3', '9 3 2 3'];
  const symbols = ['M-3 0A3 3 0 1 1 3 0A3 3 0 1 1 -3 0', 'M-3 -3H3V3H-3Z', 'M0 -4L4 3H-4Z', 'M0 -4L4 0L0 4L-4 0Z', 'M-3.5 -3.5L3.5 3.5M-3.5 3.5L3.5 -3.5'];

  const niceSteps = (low, high, count) => {
    const raw = (high - low) / count;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((s) => s * power >= raw);
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); ++k) ticks.push(k * step);
    return ticks;
  };

  class Plot {
    constructor(figure, about) {
      Object.assign(this, { figure, about });
      this.values = about.curves.flatMap((curve) => curve.values.filter((value) => value != null));
      this.positive = this.values.filter((value) => value > 0);
      this.count = about.curves[0].values.length;
      const spread = Math.max(...this.positive) / Math.min(...this.positive);
      const signed = Math.min(...this.values) < 0;  // mutual information is
      this.log = make('input', { type: 'checkbox', checked: !signed && spread > 30, disabled: signed, onchange: () => this.show() });
      this.readout = make('p', { class: 'readout' }, '\u00a0');
      this.svg = draw('svg', { role: 'img', tabindex: 0, 'aria-label': `${about.title}. Arrow keys read the values.` });
      const keys = about.curves.map((curve, c) => make('label', {},
        draw('svg', { class: 'key', viewBox: '0 0 26 14', 'aria-hidden': 'true' },
          draw('path', { d: 'M0 7H26', class: `curve curve-${c % 5}`, 'stroke-dasharray': dashes[c % 5] }),
          draw('path', { d: symbols[c % 5], class: `curve-${c % 5}`, transform: 'translate(13 7)' })), curve.name));
      figure.append(make('div', { class: 'bar' }, keys, make('label', {}, this.log, 'logarithmic')), this.svg, this.readout, this.table());
      this.svg.addEventListener('pointermove', (event) => {
        const x = event.clientX - this.svg.getBoundingClientRect().left;
        this.point(Math.round((x - this.left) / this.step));
      });
      this.svg.addEventListener('keydown', (event) => {
        const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
        if (!step) return;
        event.preventDefault();
        this.point((this.at ?? -step) + step);
      });
      new ResizeObserver(() => this.show()).observe(figure);
    }
    y(value) {
      const t = this.log.checked ? Math.log(value / this.low) / Math.log(this.high / this.low)
        : (value - this.low) / (this.high - this.low);
      return this.top + (1 - t) * this.tall;
    }
    x(i) { return this.left + i * this.step; }
    show() {
      const width = this.svg.clientWidth || 700;
      const height = clamp(0.45 * width, 240, 400);
      Object.assign(this, { left: 64, top: 30, tall: height - 76 });
      this.step = (width - this.left - 24) / Math.max(1, this.count - 1);
      if (this.log.checked) {
        Object.assign(this, { low: Math.min(...this.positive) / 1.3, high: Math.max(...this.positive) * 1.3 });
      } else {
        const [low, high] = [Math.min(0, ...this.values), Math.max(0, ...this.values)];
        const margin = 0.04 * (high - low || 1);
        Object.assign(this, { low: low < 0 ? low - margin : 0, high: high + margin });
      }
      this.svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
      this.svg.style.height = `${height}px`;
      this.svg.replaceChildren(...this.axes(width, height), ...this.about.curves.flatMap((curve, c) => this.curve(curve, c)),
        this.cursor = draw('path', { class: 'cursor' }));
    }
    ticks() {
      if (!this.log.checked) return niceSteps(this.low, this.high, 5);
      const decades = Math.log10(this.high / this.low);
      const each = decades > 5 ? [1] : decades > 2 ? [1, 3] : [1, 2, 5];
      const ticks = [];
      for (let power = Math.floor(Math.log10(this.low)); power <= Math.log10(this.high); ++power) {
        for (const s of each) ticks.push(s * 10 ** power);
      }
      return ticks.filter((tick) => tick >= this.low && tick <= this.high);
    }
    axes(width, height) {
      const parts = [];
      const right = width - 12, bottom = this.top + this.tall;
      for (const tick of this.ticks()) {
        const y = this.y(tick);
        parts.push(draw('path', { d: `M${this.left - 6} ${y}H${right}`, class: 'grid' }),
          draw('text', { x: this.left - 10, y: y + 4, 'text-anchor': 'end' }, shorten(tick, 3)));
      }
      let start = 0;
      for (const { name, count } of this.about.sections) {
        if (start > 0) parts.push(draw('path', { d: `M${this.x(start) - this.step / 2} ${this.top - 16}V${bottom}`, class: 'section' }));
        const room = this.step * count;
        if (count && room > 8) parts.push(draw('text', { x: this.x(start) + (start ? 4 - this.step / 2 : 0), y: this.top - 8 }, room > 80 ? name : name.replace(/^level /, '').replace(/,.*/, '')));
        const every = Math.max(1, Math.ceil(28 / this.step));
        for (let i = 0; i < count; i += every) {
          parts.push(draw('text', { x: this.x(start + i), y: bottom + 18, 'text-anchor': 'middle' }, String(i)));
        }
        start += count;
      }
      parts.push(draw('path', { d: `M${this.left - 6} ${bottom}H${right}`, class: 'section', style: 'stroke-dasharray:none' }),
        draw('text', { x: (this.left + right) / 2, y: height - 8, 'text-anchor': 'middle' }, this.about.x),
        draw('text', { transform: `translate(14 ${this.top + this.tall / 2}) rotate(-90)`, 'text-anchor': 'middle' }, this.about.y));
      return parts;
    }
    curve(curve, c) {
      let path = '', pen = false, start = 0;
      const symbolsOn = this.step > 9;
      const marks = [];
      for (const { count } of this.about.sections) {
        pen = false;
        for (let i = start; i < start + count; ++i) {
          const value = curve.values[i];
          if (value == null || (this.log.checked && !(value > 0))) { pen = false; continue; }
          const [x, y] = [this.x(i).toFixed(1), this.y(value).toFixed(1)];
          path += `${pen ? 'L' : 'M'}${x} ${y}`;
          pen = true;
          if (symbolsOn) marks.push(draw('path', { d: symbols[c % 5], class: `curve-${c % 5}`, transform: `translate(${x} ${y})` }));
        }
        start += count;
      }
      return [draw('path', { d: path, class: `curve curve-${c % 5}`, 'stroke-dasharray': dashes[c % 5] }), ...marks];
    }
    name(i) {
      let start = 0;
      for (const { name, count } of this.about.sections) {
        if (i < start + count) return `${name}, iteration ${i - start}`;
        start += count;
      }
      return '';
    }
    point(i) {
      this.at = clamp(i, 0, this.count - 1);
      this.cursor.setAttribute('d', `M${this.x(this.at)} ${this.top}V${this.top + this.tall}`);
      const values = this.about.curves.map((curve) => `${curve.name} ${curve.values[this.at] == null ? '\u2013' : shorten(curve.values[this.at])}`);
      this.readout.textContent = `${this.name(this.at)}:   ${values.join('   ')}`;
    }
    table() {
      const { curves } = this.about;
      const rows = Array.from({ length: this.count }, (_, i) => make('tr', {}, make('th', { scope: 'row' }, this.name(i)),
        curves.map((curve) => make('td', { class: 'number' }, curve.values[i] == null ? '\u2013' : shorten(curve.values[i], 6)))));
      return make('details', {}, make('summary', {}, 'All values as a table'),
        make('div', { class: 'table', tabindex: 0, role: 'region', 'aria-label': this.about.title }, make('table', {},
          make('thead', {}, make('tr', {}, make('th', { scope: 'col' }, 'iteration'), curves.map((curve) => make('th', { scope: 'col', class: 'number' }, curve.name)))),
          make('tbody', {}, rows))));
    }
  }

  // ---- tables that can be sorted, texts that can be copied

  for (const table of document.querySelectorAll('.panel > .table table')) {
    const body = table.tBodies[0];
    const heads = [...table.tHead.rows[0].cells];
    if (body.rows.length < 3) continue;
    heads.forEach((head, column) => {
      if (!head.classList.contains('number') && column > 0) return;
      const sort = () => {
        const down = head.getAttribute('aria-sort') === 'descending';
        heads.forEach((each) => each.removeAttribute('aria-sort'));
        head.setAttribute('aria-sort', down ? 'ascending' : 'descending');
        const key = (row) => { const text = row.cells[column].textContent; return [parseFloat(text), text]; };
        const rows = [...body.rows].sort((a, b) => {
          const [x, s] = key(a), [y, t] = key(b);
          return Number.isNaN(x - y) ? s.localeCompare(t) : x - y;
        });
        body.append(...(down ? rows : rows.reverse()));
      };
      const button = make('button', { type: 'button', onclick: sort, title: 'Sort by this column' });
      button.append(...head.childNodes);
      head.append(button);
    });
  }

  for (const figure of document.querySelectorAll('.code')) {
    const code = figure.querySelector('code');
    const button = make('button', { type: 'button', onclick: async () => {
      try {
        await navigator.clipboard.writeText(code.textContent);
        button.textContent = 'Copied';
      } catch {  // not allowed here: select it for the user's own copy
        getSelection().selectAllChildren(code);
        button.textContent = 'Selected';
      }
      setTimeout(() => { button.textContent = 'Copy'; }, 1500);
    } }, 'Copy');
    figure.append(button);
  }

  // ---- everything in its place, as soon as it is seen

  for (const figure of document.querySelectorAll('.viewer')) {
    const about = data.viewers[figure.dataset.viewer];
    whenShown.get(figure.closest('.panel')).push(() => new (about.kind === 'compare' ? Compare : Maps)(figure, about));
  }
  for (const figure of document.querySelectorAll('.plot')) {
    whenShown.get(figure.closest('.panel')).push(() => new Plot(figure, data.plots[figure.dataset.plot]));
  }
  document.documentElement.classList.add('js');
  document.querySelector('.tabs').hidden = false;
  select(fromAddress(), false);
})();
