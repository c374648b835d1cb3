#include "program/options/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/location.h>
#include <simvis/version.h>
#include "engine/base/words.h"
#include "program/options/help_formatter.h"
#include "program/options/option_table.h"

namespace simvis {
namespace {

// CLI11's own check prints the largest double with all of its digits.
std::string above_zero(const std::string& text) {
  double value = 0;
  if (parse_number(text, value) && value > 0) return "";
  return in_quotes(text) + " is not allowed, expected a number above 0";
}

/// Checks that `text` is a whole number. CLI11 itself would read -3 as 2^64 - 3, and larger numbers as the largest one.
std::string whole_number(const std::string& text) {
  return as_number<std::uint64_t>(text) ? "" : "\"" + text + "\" is not a whole number from 0 to 2^64 - 1";
}

std::string not_empty(const std::string& text) { return text.empty() ? "it is empty" : ""; }

void add_check(CLI::Option& option, const OptionSpec& spec) {
  switch (spec.check) {
    case OptionCheck::none:
      break;
    case OptionCheck::above_zero:
      option.check(CLI::Validator(above_zero, ""));
      break;
    case OptionCheck::whole:
      option.check(CLI::Validator(whole_number, ""));
      break;
    case OptionCheck::not_empty:
      option.check(CLI::Validator(not_empty, ""));
      break;
    case OptionCheck::one_of: {
      const std::vector<std::string_view> values = words_of(spec.value, "|");
      option.check(CLI::IsMember(std::vector<std::string>(values.begin(), values.end())));
      break;
    }
  }
}

CLI::Option* declare(CLI::App& app, const OptionSpec& spec, const OptionTarget& target) {
  const std::string names(spec.names);
  return std::visit(
      [&]<typename Value>(Value* value) -> CLI::Option* {
        if constexpr (std::is_same_v<Value, bool>) {
          return app.add_flag(names, *value);
        } else {
          CLI::Option* const option = app.add_option(names, *value)->type_name(std::string(spec.value));
          if constexpr (std::is_same_v<Value, std::vector<std::string>>) option->allow_extra_args(false);
          return option;
        }
      },
      target);
}

/// --help or --version.
CLI::Option* declare_wish(CLI::App& app, const OptionSpec& spec) {
  const std::string names(spec.names);
  if (names == "--version") return app.set_version_flag(names, "simvis-run " + std::string(version()));
  return app.set_help_flag(names);
}

/// What follows the options in --help.
std::string help_footer() {
  std::string text = "Examples:\n";
  for (const UsageNote& example : usage_examples()) {
    text += "  " + std::string(example.head) + "\n      " + std::string(example.text) + "\n";
  }
  text +=
      "\nResults: DIR/CAMERA/000000.png and .exr, DIR/SCANNER.csv, DIR/SENSOR_poses.csv, DIR/run.json.\n\nExit status:";
  for (const UsageNote& status : exit_statuses())
    text += "\n  " + std::string(status.head) + ": " + std::string(status.text);
  return text;
}

void declare_options(CLI::App& app, Options& options) {
  app.add_option("SCENE.xml", options.scene, "the scene to run");
  for (const OptionSpec& spec : option_table()) {
    const std::optional<OptionTarget> target = target_of(spec, options);
    CLI::Option* const option = target ? declare(app, spec, *target) : declare_wish(app, spec);
    option->description(help_text(spec))->group(std::string(title_of(spec.group)));
    if (const std::string value = default_text(spec); !value.empty()) option->default_str(value);
    if (spec.is_value_optional) option->expected(0, 1);
    if (spec.splits_at_commas) option->delimiter(',');
    add_check(*option, spec);
  }
  for (const OptionExclusion& exclusion : option_exclusions()) {
    CLI::Option* const option = app.get_option(std::string(exclusion.option));
    for (const std::string_view other : words_of(exclusion.others)) {
      option->excludes(app.get_option(std::string(other)));
    }
  }
  app.footer(help_footer());
}

/// Throws for an option that is given without any of those that it belongs to.
void require_needed(const CLI::App& app) {
  for (const OptionSpec& spec : option_table()) {
    if (spec.needs.empty() || app.count(std::string(spec.names)) == 0) continue;
    const std::vector<std::string_view> needed = words_of(spec.needs);
    if (std::ranges::any_of(needed, [&](std::string_view name) { return app.count(std::string(name)) > 0; })) continue;
    std::string names;
    for (const std::string_view name : needed) {
      names += (names.empty() ? "" : name == needed.back() ? " or " : ", ") + std::string(name);
    }
    throw InputError(std::string(spec.names) + " requires " + names + "; see --help");
  }
}

/// The port behind --live may be missing: CLI11 itself would take the scene for it.
void give_default_port(std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] != "--live") continue;
    const bool has_port = i + 1 < arguments.size() && whole_number(arguments[i + 1]).empty();
    if (!has_port) arguments[i] += "=" + std::to_string(kDefaultLivePort);
  }
}

/// The message for an option that does not exist. CLI11 itself would blame the argument behind it, which it takes for
/// the scene.
std::optional<std::string> unknown_option(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string& argument : app.remaining()) {
    if (!argument.starts_with("-")) continue;
    const std::string option = argument.substr(0, argument.find('='));
    return "there is no option " + option + suggestion(option, known);
  }
  return std::nullopt;
}

/// The message for `--set NAME VALUE`, of which CLI11 takes VALUE for the scene.
std::optional<std::string> split_assignment(const Options& options) {
  for (const std::string& assignment : options.set) {
    if (assignment.find('=') != std::string::npos) continue;
    return "--set " + assignment + ": expected ELEMENT.PARAM=VALUE in one argument";
  }
  return std::nullopt;
}

/// Warnings of results whose names end otherwise than what is in them, such as --record a.bag.
std::vector<std::string> misleading_names(const CLI::App& app) {
  std::vector<std::string> warnings;
  for (const OptionSpec& spec : option_table()) {
    const std::string name(spec.names);
    if (spec.group != OptionGroup::results || !spec.value.starts_with("FILE.") || app.count(name) == 0) continue;
    const std::filesystem::path file = app.get_option(name)->as<std::string>();
    std::error_code error;
    const bool is_other = std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error);
    if (!file.has_filename() || is_other) continue;
    std::string endings;
    bool is_known = false;
    for (const std::string_view form : words_of(spec.value, "|")) {
      const std::size_t dot = form.find('.');
      if (dot == form.npos) continue;
      is_known = is_known || file.extension() == form.substr(dot);
      endings += (endings.empty() ? "" : ", ") + std::string(form.substr(dot));
    }
    if (is_known) continue;
    warnings.push_back(name + " " + file.string() + ": expected a name that ends with " + endings +
                       ", by which other programs know the format");
  }
  return warnings;
}

void read_rate(Options& options) {
  options.simulation.frames_when_due = options.rate == "auto";
  if (options.simulation.frames_when_due || parse_number(options.rate, options.simulation.rate_hz)) return;
  throw InputError("--rate: " + in_quotes(options.rate) + " is not allowed, expected a number (Hz) or auto");
}

void require_free_options(const CLI::App& app, const std::string& with) {
  const auto is_given = [&](std::string_view name) { return app.count(std::string(name)) > 0; };
  for (const OptionSpec& spec : option_table()) {
    const std::vector<std::string_view> names = words_of(spec.names, ",");
    if (std::ranges::none_of(names, is_given)) continue;
    const std::string name(names.back());
    if (spec.changes_no_result && !(name == "--frames" && with == "--again")) continue;
    if (name == "--plugin") continue;  // require_same_plugins()
    throw InputError(with + ": " + name + " is fixed by the run, expected it without");
  }
}

/// A plug-in is code: it is loaded if the user names it, not because a report does.
void require_same_plugins(const EarlierRun& run, const Options& recorded, const Options& given) {
  for (const std::string& plugin : recorded.plugins) {
    if (std::ranges::find(given.plugins, plugin) != given.plugins.end()) continue;
    throw InputError(run.report.string() + ": error: the run loaded the plug-in " + in_quotes(plugin) +
                     ", which is code, expected --plugin " + plugin + " again if you trust it");
  }
  for (const std::string& plugin : given.plugins) {
    if (std::ranges::find(recorded.plugins, plugin) != recorded.plugins.end()) continue;
    throw InputError("--plugin: the run in " + run.report.string() + " has not loaded " + in_quotes(plugin) +
                     ", expected it without");
  }
}

std::vector<std::string> set_recorded_environment(const EarlierRun& run) {
  std::vector<std::string> warnings;
  for (const std::string& name : set_environment(run.environment)) {
    warnings.push_back(run.report.string() + ": the recorded environment variable " + in_quotes(name) +
                       " is ignored, since it leads to no package; set it yourself if the run needs it");
  }
  return warnings;
}

/// Copies the values of the options that change no result.
void copy_free_options(Options& from, Options& to) {
  for (const OptionSpec& spec : option_table()) {
    if (!spec.changes_no_result) continue;
    std::visit([&]<typename Value>(Value* target) { *target = *std::get<Value*>(*target_of(spec, from)); },
               *target_of(spec, to));
  }
}

}  // namespace

ParsedOptions parse_options(std::vector<std::string> arguments) {
  ParsedOptions parsed;
  Options& options = parsed.options;
  options.command = arguments;
  CLI::App app("simvis-run " + std::string(kProgramSummary) + ".", "simvis-run");
  app.formatter(std::make_shared<HelpFormatter>());
  declare_options(app, options);
  give_default_port(arguments);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp& wish) {
    if (options.markdown) {
      std::cout << option_document();
      parsed.exit_status = 0;
    } else {
      parsed.exit_status = app.exit(wish);
    }
    return parsed;
  } catch (const CLI::Success& wish) {
    parsed.exit_status = app.exit(wish);
    return parsed;
  } catch (const CLI::ParseError& error) {
    const std::optional<std::string> known = split_assignment(options);
    throw InputError(known.value_or(unknown_option(app).value_or(error.what())) + "; see --help");
  }
  require_needed(app);
  parsed.warnings = misleading_names(app);
  options.names_out = app.count("--out") > 0;
  options.names_frames = app.count("--frames") > 0;
  options.names_export_resolution = app.count("--export-resolution") > 0;
  options.dds = app.count("--dds") > 0;
  double domain = 0;
  if (options.scene.empty() && !parse_number(options.dds_domain, domain)) {
    std::swap(options.scene, options.dds_domain);  // --dds SCENE.xml
  }
  options.endless = is_shared(options) && !options.names_frames && options.trajectory.empty();
  options.writes = ((!options.live && !options.dds) || options.names_out) && options.datasets.empty();
  read_rate(options);
  if (!options.again.empty()) require_free_options(app, "--again");
  if (options.resume && options.scene.empty()) require_free_options(app, "--resume");
  return parsed;
}

bool is_shared(const Options& options) {
  return !options.serve.empty() || !options.follow.empty() || options.live || options.dds;
}

void require_own_run(const EarlierRun& run) {
  if (!is_shared(parse_options(run.command).options)) return;
  throw InputError(run.report.string() +
                   ": error: other processes took part in the run, which is not recorded, expected a new run");
}

RecordedOptions recorded_options(Options given) {
  const bool again = !given.again.empty();
  const EarlierRun run =
      read_report(again ? std::filesystem::path(given.again) : std::filesystem::path(given.out) / "run.json");
  if (run.command.empty()) throw InputError(run.report.string() + ": error: holds no command line");
  require_own_run(run);
  Options options = parse_options(run.command).options;
  if (!options.again.empty() || options.scene.empty()) {
    throw InputError(run.report.string() + ": error: its command line names no scene");
  }
  require_same_plugins(run, options, given);
  const std::string recorded_device = options.simulation.device.select;
  copy_free_options(given, options);
  if (options.simulation.device.select.empty()) options.simulation.device.select = recorded_device;
  options.names_export_resolution = given.names_export_resolution;
  options.names_frames |= given.names_frames;
  options.frames = given.names_frames ? given.frames : run.frames_wanted;
  return {std::move(options), set_recorded_environment(run)};
}

}  // namespace simvis
