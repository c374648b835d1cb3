// What --help and docs/command-line.md print of the table of options.
#include <array>

#include <simvis/attributes.h>
#include "engine/base/words.h"
#include "program/options/option_table.h"
#include "program/options/settings.h"
#include "program/output/formats.h"

namespace simvis {
namespace {

constexpr std::array<std::string_view, 6> kTitles = {
    "The run", "Sensors", "Results", "Reports on a run", "Other processes and machines", "Instead of a run"};

constexpr UsageNote kExamples[] = {
    {"simvis-run scene.xml", "one frame; the results go to out/"},
    {"simvis-run --live scene.xml", "the running scene in a browser"},
    {"simvis-run --frames 100 --rate 20 --record run.mcap scene.xml", "100 frames, also as ROS 2 messages"},
    {"simvis-run --dataset coco --frames 500 --out data scene.xml", "a dataset of 500 frames"},
    {"simvis-run --price scene.xml", "what each method costs and how exact it is in this scene"},
    {"simvis-run --describe laser_scanner", "what a type does, with its attributes"},
};

constexpr UsageNote kExitStatuses[] = {
    {"0", "done"},
    {"1", "it could not be done"},
    {"2", "the command line or the scene is wrong"},
    {"130", "stopped by a signal"},
};

std::string in_code(std::string_view text) { return "`" + std::string(text) + "`"; }

/// The words as "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string_view>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += in_code(words[i]);
  }
  return text;
}

/// What the option does, as Markdown.
std::string marked_text(const OptionSpec& option) {
  std::string text;
  if (!option.needs.empty()) text += "with " + alternatives(words_of(option.needs, " ")) + ": ";
  if (!option.setting.empty()) {
    const SettingSpec& setting = simulation_setting(option.setting);
    text += setting.text;
    if (!option.absent_word.empty()) text += "; " + in_code(option.absent_word) + ": " + std::string(setting.absent);
  }
  text += option.text;
  if (option.facts != nullptr) text += " (" + option.facts() + ")";
  Options options;
  const std::optional<OptionTarget> target = target_of(option, options);
  if (target && std::holds_alternative<std::vector<std::string>*>(*target)) text += " (repeatable)";
  return text;
}

/// The cell of a table: "|" would end it.
std::string in_cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, "\\");
  return text;
}

std::string document_row(const OptionSpec& option) {
  std::string names;
  for (const std::string_view name : words_of(option.names, ",")) {
    names += (names.empty() ? "" : ", ") +
             in_code(std::string(name) + (option.value.empty() ? "" : " ") + std::string(option.value));
  }
  std::string text = marked_text(option) + std::string(option.more);
  if (const std::string value = default_text(option); !value.empty()) text += " (default: " + in_code(value) + ")";
  return "| " + in_cell(names) + " | " + in_cell(text) + " |\n";
}

}  // namespace

std::string_view title_of(OptionGroup group) { return kTitles.at(static_cast<std::size_t>(group)); }

std::span<const UsageNote> usage_examples() { return kExamples; }

std::span<const UsageNote> exit_statuses() { return kExitStatuses; }

std::string default_text(const OptionSpec& option) {
  Options options;
  const std::optional<OptionTarget> target = target_of(option, options);
  if (!target || option.hides_default) return "";
  return std::visit(
      []<typename Value>(const Value* value) -> std::string {
        if constexpr (std::is_same_v<Value, double>) return format_number(*value);
        if constexpr (std::is_same_v<Value, unsigned> || std::is_same_v<Value, std::uint64_t>) {
          return std::to_string(*value);
        }
        if constexpr (std::is_same_v<Value, std::string>) return *value;
        return "";
      },
      *target);
}

std::string help_text(const OptionSpec& option) {
  std::string text = marked_text(option);
  std::erase(text, '`');
  return text;
}

std::string option_document() {
  std::string page;
  for (const OptionSpec& option : option_table()) {
    const bool is_first = &option == option_table().data() || (&option)[-1].group != option.group;
    if (is_first) {
      page += (page.empty() ? "### " : "\n### ") + std::string(title_of(option.group)) +
              "\n\n| option | meaning |\n|---|---|\n";
    }
    page += document_row(option);
  }
  page += "\n### File formats\n\n| `--format` | file in `DIR` | content |\n|---|---|---|\n";
  for (const FormatSpec& format : format_table()) {
    const std::string name = std::string(format.kind) + "=" + std::string(format.name);
    page += "| " + in_code(name) + (format.is_default ? " (default)" : "") + " | " + in_code(format.file) + " | " +
            in_cell(std::string(format.text)) + " |\n";
  }
  return page;
}

}  // namespace simvis
