#include "program/options/completion.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/words.h"
#include "program/options/option_table.h"

namespace simvis {
namespace {

enum class ValueForm : std::uint8_t { none, free, words, file, folder };

/// An option, or the scene, as shells see it.
struct Completed {
  std::vector<std::string_view> names{};  ///< "-o", "--out"; none: the scene
  std::string_view value{};               ///< what stands for the value
  ValueForm form = ValueForm::none;
  std::string words{};                 ///< of form `words`, separated by spaces
  std::vector<std::string> endings{};  ///< of form `file`: "xml"
  std::string text{};                  ///< what it does, without quotes
  bool repeats = false, is_value_optional = false;
};

bool is_word(std::string_view text) {
  return std::ranges::all_of(text, [](unsigned char c) { return std::islower(c) != 0 || c == '-'; });
}

/// The text up to its first clause, without characters that have a meaning in the scripts.
std::string short_text(const OptionSpec& option) {
  std::string text = help_text(option);
  text = text.substr(option.needs.empty() ? 0 : text.find(": ") + 2);
  text = text.substr(0, std::min({text.find("; "), text.find(". "), text.find(" ("), text.find(": ")}));
  std::erase_if(text, [](char c) { return std::string_view("'\"`\\[]:$").find(c) != std::string_view::npos; });
  return text;
}

/// Reads the form out of what stands for the value: lower-case words stand for themselves, "FILE.csv" for files with
/// this ending, "DIR" for folders.
void read_value(const OptionSpec& option, Completed& completed) {
  completed.form = ValueForm::free;
  if (option.choices != nullptr) completed.words = option.choices();
  for (const std::string_view alternative : words_of(option.value, "|")) {
    const std::size_t dot = alternative.rfind('.');
    if (is_word(alternative)) completed.words += (completed.words.empty() ? "" : " ") + std::string(alternative);
    if (dot != std::string_view::npos && is_word(alternative.substr(dot + 1)) && !alternative.ends_with('.')) {
      completed.endings.emplace_back(alternative.substr(dot + 1));
    }
  }
  if (option.value == "DIR") completed.form = ValueForm::folder;
  if (!completed.endings.empty()) completed.form = ValueForm::file;
  if (!completed.words.empty()) completed.form = ValueForm::words;
}

Completed completed_option(const OptionSpec& option) {
  Options options;
  const std::optional<OptionTarget> target = target_of(option, options);
  Completed completed{.names = words_of(option.names, ","),
                      .value = option.value,
                      .text = short_text(option),
                      .repeats = target && std::holds_alternative<std::vector<std::string>*>(*target),
                      .is_value_optional = option.value.starts_with('[') && option.value.ends_with(']')};
  if (!option.value.empty()) read_value(option, completed);
  return completed;
}

std::vector<Completed> completed_options() {
  std::vector<Completed> all;
  for (const OptionSpec& option : option_table()) all.push_back(completed_option(option));
  return all;
}

std::string joined(const std::vector<std::string_view>& words, std::string_view separator) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : std::string(separator)) + std::string(word);
  return text;
}

std::string bash_values(const Completed& option) {
  switch (option.form) {
    case ValueForm::words:
      return "_simvis_run_words '" + option.words + "'";
    case ValueForm::file: {
      std::string call = "_simvis_run_files";
      for (const std::string& ending : option.endings) call += " " + ending;
      return call;
    }
    case ValueForm::folder:
      return "_simvis_run_files";
    case ValueForm::none:
    case ValueForm::free:
      break;
  }
  return ":";
}

/// bash divides --out=DIR into three words.
std::string bash_script() {
  std::string cases, names;
  for (const Completed& option : completed_options()) {
    names += (names.empty() ? "" : " ") + joined(option.names, " ");
    if (option.form == ValueForm::none) continue;
    cases += "    " + joined(option.names, " | ") + ") " + bash_values(option) +
             (option.is_value_optional ? " ;;\n" : "; return ;;\n");
  }
  return R"(# Completion of simvis-run for bash. Generated: simvis-run --completion bash
_simvis_run_words() {
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word")
}
# Folders, and files with one of these endings.
_simvis_run_files() {
  local ending
  compopt -o filenames
  mapfile -t COMPREPLY < <(
    compgen -d -- "$word"
    for ending; do compgen -f -X "!*.$ending" -- "$word"; done
  )
}
_simvis_run() {
  local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD - 1]}
  if [[ $word == = ]]; then
    word=
  elif [[ $option == = ]]; then
    option=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
  case $option in
)" + cases +
         "  esac\n  if [[ $word == -* ]]; then\n    _simvis_run_words '" + names +
         "'\n  elif [[ ${#COMPREPLY[@]} == 0 ]]; then\n    _simvis_run_files xml\n  fi\n}\ncomplete -F _simvis_run "
         "simvis-run\n";
}

std::string zsh_action(const Completed& option) {
  switch (option.form) {
    case ValueForm::words:
      return "(" + option.words + ")";
    case ValueForm::file: {
      std::string patterns;
      for (const std::string& ending : option.endings) patterns += (patterns.empty() ? "*." : " *.") + ending;
      return "_files -g \"" + patterns + "\"";
    }
    case ValueForm::folder:
      return "_files -/";
    case ValueForm::none:
    case ValueForm::free:
      break;
  }
  return " ";
}

std::string zsh_option(const Completed& option) {
  std::string name(option.names.back()), front;
  const std::string equals = option.form == ValueForm::none ? "" : "=";
  if (option.names.size() > 1) {
    front = "'(" + joined(option.names, " ") + ")'{" + std::string(option.names.front()) + "," + name + equals + "}'";
  } else {
    front = std::string("'") + (option.repeats ? "*" : "") + name + equals;
  }
  std::string value(option.value);
  std::erase_if(value, [](char c) { return c == ':' || c == '[' || c == ']'; });
  const std::string argument =
      option.form == ValueForm::none ? "" : (option.is_value_optional ? "::" : ":") + value + ":" + zsh_action(option);
  return "  " + front + "[" + option.text + "]" + argument + "' \\\n";
}

std::string zsh_script() {
  std::string text =
      "#compdef simvis-run\n# Completion of simvis-run for zsh. Generated: simvis-run --completion zsh\n_arguments "
      "\\\n";
  for (const Completed& option : completed_options()) text += zsh_option(option);
  return text + "  ':scene:_files -g \"*.xml\"'\n";
}

std::string fish_option(const Completed& option) {
  std::string line = "complete -c simvis-run";
  for (const std::string_view name : option.names) {
    line += name.starts_with("--") ? " -l " + std::string(name.substr(2)) : " -s " + std::string(name.substr(1));
  }
  switch (option.form) {
    case ValueForm::none:
      break;
    case ValueForm::free:
      line += option.is_value_optional ? "" : " -x";
      break;
    case ValueForm::words:
      line += " -x -a '" + option.words + "'";
      break;
    case ValueForm::file:
      line += " -x -a '(__simvis_run_files " + joined({option.endings.begin(), option.endings.end()}, " ") + ")'";
      break;
    case ValueForm::folder:
      line += " -x -a '(__fish_complete_directories)'";
      break;
  }
  return line + " -d '" + option.text + "'\n";
}

std::string fish_script() {
  std::string text = R"(# Completion of simvis-run for fish. Generated: simvis-run --completion fish
# Folders, and files with one of these endings.
function __simvis_run_files
  set -l path (string replace -r -- '^-[^=]*=' '' (commandline -ct))
  __fish_complete_path $path | string match -r '^[^\t]*(?:/|\.(?:'(string join '|' $argv)'))(?:\t.*)?$'
end
complete -c simvis-run -f -a '(__simvis_run_files xml)'
)";
  for (const Completed& option : completed_options()) text += fish_option(option);
  return text;
}

}  // namespace

std::string completion_script(std::string_view shell) {
  if (shell == "bash") return bash_script();
  if (shell == "zsh") return zsh_script();
  SIMVIS_ASSERT(shell == "fish");
  return fish_script();
}

}  // namespace simvis
