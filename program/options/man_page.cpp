#include "program/options/man_page.h"

#include <string_view>

#include <simvis/version.h>
#include "engine/base/words.h"
#include "program/options/option_table.h"

namespace simvis {
namespace {

/// Escapes what troff would take for a command. A line that begins with '.' or ' is one.
std::string in_roff(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return (escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" : "") + escaped;
}

std::string bold(std::string_view text) { return "\\fB" + in_roff(text) + "\\fR"; }

/// A paragraph with a head that hangs out to the left.
std::string entry(const std::string& head, std::string_view text) {
  return ".TP\n" + head + "\n" + in_roff(text) + "\n";
}

std::string option_entry(const OptionSpec& option) {
  std::string head;
  for (const std::string_view name : words_of(option.names, ",")) {
    head += (head.empty() ? "" : ", ") + bold(name) +
            (option.value.empty() ? "" : " \\fI" + in_roff(option.value) + "\\fR");
  }
  std::string text = help_text(option);
  if (const std::string value = default_text(option); !value.empty()) text += " (default: " + value + ")";
  return entry(head, text);
}

std::string notes(std::span<const UsageNote> list) {
  std::string text;
  for (const UsageNote& note : list) text += entry(bold(note.head), note.text);
  return text;
}

}  // namespace

std::string man_page() {
  std::string page = ".TH SIMVIS\\-RUN 1 \"\" \"SimVis " + in_roff(version()) + "\" \"User Commands\"\n" +
                     ".SH NAME\nsimvis\\-run \\- " + in_roff(kProgramSummary) +
                     "\n.SH SYNOPSIS\n.B simvis\\-run\n[\\fIOPTION\\fR]... [\\fISCENE.xml\\fR]\n.SH OPTIONS\n";
  const OptionSpec* before = nullptr;
  for (const OptionSpec& option : option_table()) {
    if (before == nullptr || before->group != option.group) page += ".SS " + in_roff(title_of(option.group)) + "\n";
    page += option_entry(option);
    before = &option;
  }
  return page + ".SH EXAMPLES\n" + notes(usage_examples()) + ".SH EXIT STATUS\n" + notes(exit_statuses());
}

}  // namespace simvis
