#include "simvis/sharing/allowed_folders.h"

#include <algorithm>
#include <string>
#include <system_error>

#include <simvis/error.h>
#include <simvis/location.h>
#include "engine/base/words.h"
#include "simvis/command_names.h"

namespace simvis {
namespace {

// Where the text ends that in_quotes() put in quotes, whose own quotes follow a backslash.
std::size_t closing_quote(std::string_view message, std::size_t opening) {
  std::size_t closing = message.find('"', opening + 1);
  while (closing != message.npos && message[closing - 1] == '\\') closing = message.find('"', closing + 1);
  return closing;
}

// xacro puts arguments into expressions, which it evaluates as code.
void check_xacro_arguments(const CommandAttribute& arguments) {
  constexpr std::string_view kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.+/-";
  for (const std::string_view word : words_of(arguments.value)) {
    std::string text(word);
    if (const std::size_t sign = text.find(":="); sign != text.npos) text.erase(sign, 2);
    if (text.find_first_not_of(kAllowed) == text.npos) continue;
    fail_at(arguments.where, "attribute \"xacro_arguments\": a request may not give " + in_quotes(word) +
                                 ", expected NAME:=VALUE of letters, digits, and _ . + / -");
  }
}

}  // namespace

AllowedFolders::AllowedFolders(std::span<const std::filesystem::path> folders) {
  for (const std::filesystem::path& folder : folders) {
    std::error_code error;
    folders_.push_back(std::filesystem::canonical(folder, error));
    if (error) throw InputError("there is no folder " + in_quotes(folder.string()) + " that requests could name");
  }
}

std::vector<Command> AllowedFolders::parse(std::string_view xml, const std::string& name) const {
  const FileCheck check_include = [this](const CommandAttribute& file, const std::filesystem::path& folder) {
    check(file, folder);
  };
  const ReadFence fence(closed_scope(folders_));
  std::vector<Command> commands = parse_commands(xml, name, start(), check_include);
  for (const Command& command : commands) {
    if (const CommandAttribute* const given = command.find("xacro_arguments")) check_xacro_arguments(*given);
    for (const CommandAttribute& attribute : command.attributes) {
      if (refers_to_file(command, attribute)) check(attribute, command.folder);
    }
  }
  return commands;
}

void AllowedFolders::carry_out(const std::function<void()>& request) const {
  const ReadFence fence(closed_scope(folders_));
  request();
}

void AllowedFolders::check(const std::filesystem::path& file) const {
  check({.name = "file", .value = file.string(), .where = {}}, {});
}

void AllowedFolders::check(const CommandAttribute& file, const std::filesystem::path& folder) const {
  const ReadFence fence(closed_scope(folders_));
  if (is_readable(folder / file.value)) return;
  std::string allowed;
  for (const std::filesystem::path& each : folders_) allowed += (allowed.empty() ? "" : ", ") + each.string();
  fail_at(file.where, "a request may not use the file " + in_quotes(file.value) + ", expected one below " +
                          (allowed.empty() ? "no folder: none was allowed" : allowed));
}

std::filesystem::path AllowedFolders::start() const { return folders_.empty() ? "." : folders_.front(); }

std::string without_file_content(std::string_view message, std::string_view request) {
  constexpr std::string_view kSuggests = "did you mean ";
  std::string text;
  while (!message.empty()) {
    const std::size_t opening = message.find('"');
    const std::size_t closing = opening == message.npos ? opening : closing_quote(message, opening);
    text += message.substr(0, opening);
    if (opening == message.npos) break;
    const std::size_t end = std::min(closing, message.size());
    const std::string_view quoted = message.substr(opening + 1, end - opening - 1);
    const bool is_known = text.ends_with(kSuggests) || (!quoted.empty() && request.find(quoted) != request.npos);
    text += '"' + (is_known ? std::string(quoted) : "...") + '"';
    message.remove_prefix(std::min(end + 1, message.size()));
  }
  return text;
}

}  // namespace simvis
