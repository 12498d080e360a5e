#include "Applications/Report/HtmlReport.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "Applications/Report/ReportFiles.h"
#include "Applications/Report/ReportJson.h"
#include "Applications/Version.h"

namespace crease {
namespace {

const char* mood_name(ReportMood mood) {
  switch (mood) {
    case ReportMood::kGood:
      return "good";
    case ReportMood::kCaution:
      return "caution";
    case ReportMood::kBad:
      return "bad";
    case ReportMood::kPlain:
      break;
  }
  return "plain";
}

/// A sign that says without colour what the mood's colour says.
const char* mood_sign(ReportMood mood) {
  switch (mood) {
    case ReportMood::kGood:
      return "\u2713";
    case ReportMood::kCaution:
      return "!";
    case ReportMood::kBad:
      return "\u2717";
    case ReportMood::kPlain:
      break;
  }
  return "\u2022";
}

std::string signed_text(const ReportHead::Statement& statement) {
  return fmt::format(R"(<span class="sign" aria-hidden="true">{}</span> {})",
                     mood_sign(statement.mood), escape_html(statement.text));
}

/// The template with each {{name}} replaced; what is put in is not searched again.
std::string filled(std::string_view page, const std::map<std::string, std::string>& values) {
  std::string result;
  while (true) {
    const auto open = page.find("{{");
    result += page.substr(0, open);
    if (open == std::string_view::npos) return result;
    const auto close = page.find("}}", open);
    result += values.at(std::string(page.substr(open + 2, close - open - 2)));
    page.remove_prefix(close + 2);
  }
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  const auto byte = [&](std::size_t i) {
    return i < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i])) : 0U;
  };
  std::size_t to = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 3, to += 4) {
    const unsigned three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (std::size_t d = 0; d < 4; ++d) {
      if (i + d <= bytes.size()) text[to + d] = kDigits[three >> (18 - 6 * d) & 63];
    }
  }
  return text;
}

}  // namespace

std::string escape_html(const std::string& text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

HtmlReport::HtmlReport(ReportHead head) : head_(std::move(head)) {}

std::string& HtmlReport::body() {
  if (sections_.empty()) begin_section("report", "Report");
  return sections_.back().body;
}

void HtmlReport::begin_section(const std::string& id, const std::string& title) {
  sections_.push_back({id, title, {}});
}

void HtmlReport::add_text(const std::string& paragraph) {
  body() += "<p>" + escape_html(paragraph) + "</p>\n";
}

void HtmlReport::add_note(const std::string& paragraph) {
  body() += "<p class=\"note\">" + escape_html(paragraph) + "</p>\n";
}

void HtmlReport::add_table(const ReportTable& table) {
  const auto is_number = [&](std::size_t column) {
    return std::ranges::count(table.numbers, static_cast<int>(column)) > 0;
  };
  std::string& to = body();
  if (table.varies) to += "<!--varies-->";
  constexpr std::size_t kLong = 40;  // rows: then the table scrolls
  to += table.rows.size() > kLong ? "<div class=\"table long\"" : "<div class=\"table\"";
  to += " role=\"region\" tabindex=\"0\" aria-label=\"" + escape_html(table.title) +
        "\"><table><caption>" + escape_html(table.title) + "</caption>\n<thead><tr>";
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    to += fmt::format("<th scope=\"col\"{}>{}</th>", is_number(c) ? " class=\"number\"" : "",
                      escape_html(table.columns[c]));
  }
  to += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    to += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const char* const tag = c == 0 ? "th" : "td";
      to += fmt::format("<{0}{1}{2}>{3}</{0}>", tag, c == 0 ? " scope=\"row\"" : "",
                        is_number(c) ? " class=\"number\"" : "", escape_html(row[c]));
    }
    to += "</tr>\n";
  }
  to += "</tbody></table></div>\n";
  if (!table.note.empty()) add_note(table.note);
  if (table.varies) to += "<!--/varies-->\n";
}

void HtmlReport::add_code(const std::string& title, const std::string& code) {
  body() += "<figure class=\"code\"><figcaption>" + escape_html(title) +
            "</figcaption><pre tabindex=\"0\"><code>" + escape_html(code) +
            "</code></pre></figure>\n";
}

void HtmlReport::add_plot(ReportPlot plot) {
  body() +=
      fmt::format("<figure class=\"plot\" data-plot=\"{}\"><figcaption>{}</figcaption></figure>\n",
                  plots_.size(), escape_html(plot.title));
  plots_.push_back(std::move(plot));
}

int HtmlReport::add_stack(ReportStack stack) {
  stacks_.push_back(std::move(stack));
  return static_cast<int>(stacks_.size()) - 1;
}

void HtmlReport::add_viewer(ReportViewer viewer) {
  body() += fmt::format(
      "<figure class=\"viewer\" data-viewer=\"{}\"><figcaption>{}</figcaption></figure>\n",
      viewers_.size(), escape_html(viewer.title));
  if (!viewer.note.empty()) add_note(viewer.note);
  viewers_.push_back(std::move(viewer));
}

std::string HtmlReport::head_html() const {
  std::string html =
      fmt::format("<p class=\"kicker\">{} <span class=\"badge {}\">{}</span></p>\n<h1>{}</h1>\n",
                  escape_html(head_.command), mood_name(head_.status.mood),
                  signed_text(head_.status), escape_html(head_.title));
  html += "<ul class=\"verdict\">\n";
  for (const auto& statement : head_.verdict) {
    html += fmt::format("<li class=\"{}\">{}</li>\n", mood_name(statement.mood),
                        signed_text(statement));
  }
  html += "</ul>\n<dl class=\"figures\">\n";
  for (const auto& figure : head_.figures) {
    html +=
        fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n",
                    escape_html(figure.label), escape_html(figure.value), escape_html(figure.note));
  }
  html += "</dl>\n";
  if (!head_.warnings.empty()) {
    html += fmt::format(
        "<section class=\"warnings\" aria-label=\"Warnings\"><h2>{} warning{}</h2>\n<ul>\n",
        head_.warnings.size(), head_.warnings.size() > 1 ? "s" : "");
    for (const auto& warning : head_.warnings) html += "<li>" + escape_html(warning) + "</li>\n";
    html += "</ul></section>\n";
  }
  return html;
}

std::string HtmlReport::tabs_html() const {
  std::string html;
  for (const Section& section : sections_) {
    html += fmt::format(
        "<button type=\"button\" role=\"tab\" id=\"tab-{0}\" aria-controls=\"{0}\">{1}</button>\n",
        escape_html(section.id), escape_html(section.title));
  }
  return html;
}

std::string HtmlReport::sections_html() const {
  std::string html;
  for (const Section& section : sections_) {
    html += fmt::format(
        "<section id=\"{0}\" class=\"panel\" aria-labelledby=\"tab-{0}\">\n<h2>{1}</h2>\n{2}"
        "</section>\n",
        escape_html(section.id), escape_html(section.title), section.body);
  }
  return html;
}

std::string HtmlReport::data_html() const {
  std::string html = "<script type=\"application/json\" id=\"report-data\">" +
                     report_json(stacks_, viewers_, plots_) + "</script>\n";
  for (std::size_t s = 0; s < stacks_.size(); ++s) {
    for (std::size_t l = 0; l < stacks_[s].layers.size(); ++l) {
      for (std::size_t p = 0; p < stacks_[s].layers[l].png.size(); ++p) {
        html += fmt::format("<script type=\"text/plain\" id=\"pixels-{}-{}-{}\">", s, l, p);
        html += base64(stacks_[s].layers[l].png[p]);
        html += "</script>\n";
      }
    }
  }
  return html;
}

std::string HtmlReport::html() const {
  return filled(kReportHtml, {{"title", escape_html(head_.command + ": " + head_.title)},
                              {"style", std::string(kReportCss)},
                              {"script", std::string(kReportJs)},
                              {"head", head_html()},
                              {"tabs", tabs_html()},
                              {"sections", sections_html()},
                              {"data", data_html()},
                              {"version", version_number()}});
}

}  // namespace crease
