#pragma once

#include <string>
#include <vector>

#include "Applications/Report/ReportFigures.h"

namespace crease {

enum class ReportMood { kGood, kCaution, kBad, kPlain };

/// What stands at the top of a report.
struct ReportHead {
  struct Statement {
    ReportMood mood = ReportMood::kPlain;
    std::string text;
  };
  struct Figure {
    std::string label, value, note;
  };
  std::string command;  ///< "crease register"
  std::string title;    ///< what was done to what
  Statement status;     ///< "finished", "not converged"
  std::vector<Statement> verdict;
  std::vector<Figure> figures;
  std::vector<std::string> warnings;
};

/// A page for people, one file that needs nothing else: no network, no fonts, no pictures beside it. A head,
/// and sections that become tabs. It works from a disk, by keyboard, on narrow screens, in light and dark,
/// and prints whole.
///
/// What a run puts into it is text, tables, curves and stacks of pixels; how they look and behave is in
/// report.css and report.js, which are built into the program. All texts are escaped.
class HtmlReport {
 public:
  explicit HtmlReport(ReportHead head);

  /// What is added from now on belongs to this section. @param id  letters and hyphens: its address.
  void begin_section(const std::string& id, const std::string& title);
  void add_text(const std::string& paragraph);
  /// A paragraph in small print, on what stands above.
  void add_note(const std::string& paragraph);
  void add_table(const ReportTable& table);
  /// Text to be copied, such as a configuration.
  void add_code(const std::string& title, const std::string& code);
  void add_plot(ReportPlot plot);
  /// @return the number by which viewers name it.
  int add_stack(ReportStack stack);
  void add_viewer(ReportViewer viewer);

  /// The page.
  std::string html() const;

 private:
  struct Section {
    std::string id, title, body;
  };
  std::string& body();
  std::string head_html() const;
  std::string tabs_html() const;
  std::string sections_html() const;
  std::string data_html() const;

  ReportHead head_;
  std::vector<Section> sections_;
  std::vector<ReportStack> stacks_;
  std::vector<ReportViewer> viewers_;
  std::vector<ReportPlot> plots_;
};

/// Text as HTML shows it, in elements and in quoted attributes.
std::string escape_html(const std::string& text);

}  // namespace crease
