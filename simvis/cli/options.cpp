#include "simvis/cli/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <memory>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/location.h>
#include <simvis/version.h>
#include "simvis/cli/help_formatter.h"
#include "simvis/report/earlier_run.h"
#include "simvis/report/price.h"

namespace simvis {
namespace {

// Where Foxglove looks for a server.
constexpr std::uint16_t kDefaultLivePort = 8765;

// The group of options that CLI11 puts options into whose group is not said.
constexpr std::string_view kUnnamedGroup = "Options";

// CLI11's own check prints the largest double with all of its digits.
CLI::Validator above_zero() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        double value = 0;
        if (parse_number(text, value) && value > 0) return "";
        return in_quotes(text) + " is not allowed, expected a number above 0";
      },
      "");
}

/// Checks that `text` is a whole number. CLI11 itself would read -3 as 2^64 - 3, and larger numbers as the largest one.
std::string whole_number(const std::string& text) {
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return rest == end && error == std::errc() ? "" : "\"" + text + "\" is not a whole number from 0 to 2^64 - 1";
}

std::string not_empty(const std::string& text) { return text.empty() ? "it is empty" : ""; }

void declare_dds_options(CLI::App& app, Options& options) {
  CLI::Option* const dds =
      app.add_option("--dds", options.dds_domain,
                     "send the frames as ROS 2 messages by DDS, and take values and change requests from there; "
                     "without --frames it goes on until it is interrupted. docs/messages.md lists the topics")
          ->type_name("[DOMAIN]")
          ->expected(0, 1);
  app.add_option("--dds-topics", options.dds_topics,
                 "with --dds: only topics that match a pattern with * and ? (repeatable)")
      ->type_name("PATTERN,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(not_empty)
      ->needs(dds);
  app.add_option("--dds-qos", options.dds_qos,
                 "with --dds, measurements that the network loses: are lost (sensor-data), or sent again (reliable)")
      ->type_name("sensor-data|reliable")
      ->check(CLI::IsMember({"sensor-data", "reliable"}))
      ->capture_default_str()
      ->needs(dds);
}

void declare_serve_options(CLI::App& app, Options& options) {
  CLI::Option* const serve =
      app.add_option("--serve", options.serve,
                     "let other processes read and write the running simulation under this name; without --frames it "
                     "goes on until it is interrupted")
          ->type_name("NAME")
          ->check(not_empty);
  app.add_flag("--serve-group", options.serve_group,
               "with --serve: members of this process's group may connect too, not its user alone")
      ->needs(serve);
  app.add_option("--allow", options.allow,
                 "requests of clients may read part files below this folder (repeatable; default: the scene's)")
      ->type_name("DIR")
      ->allow_extra_args(false);
  CLI::Option* const lockstep =
      app.add_option("--lockstep", options.lockstep, "each frame waits until these clients are ready for it")
          ->type_name("CLIENT,...")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->needs(serve);
  app.add_option("--lockstep-timeout", options.lockstep_timeout_s,
                 "the run ends with status 1 if a client is not ready after so many seconds")
      ->type_name("S")
      ->check(above_zero())
      ->capture_default_str()
      ->needs(lockstep);
  app.add_option(
         "--follow", options.follow,
         "show the simulation that another process serves under this name, on another machine with dds: in front; "
         "SCENE.xml, which may be missing, has what comes to its scene, such as cameras with view=\"visualization\" "
         "and laser beams")
      ->type_name("NAME|dds:[DOMAIN/]NAME")
      ->check(not_empty);
  app.add_option("--real-time", options.real_time,
                 "keep to the wall clock: simulated seconds for each second; a run that is too slow says so")
      ->type_name("FACTOR")
      ->check(above_zero());
}

void declare_live_options(CLI::App& app, Options& options) {
  CLI::Option* const live =
      app.add_option("--live", options.live,
                     "show the running scene in a browser, and to Foxglove, at this port (" +
                         std::to_string(kDefaultLivePort) +
                         "; 0: any free one), and print the link; without --frames it goes on until it is interrupted, "
                         "and without --out it writes no files")
          ->type_name("[PORT]");
  app.add_option("--live-address", options.live_address,
                 "with --live: other machines may connect too, at this address of this one, with the printed link")
      ->type_name("ADDRESS")
      ->check(not_empty)
      ->needs(live);
}

/// The port behind --live may be missing: CLI11 itself would take the scene for it.
void give_default_port(std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] != "--live") continue;
    const bool has_port = i + 1 < arguments.size() && whole_number(arguments[i + 1]).empty();
    if (!has_port) arguments[i] += "=" + std::to_string(kDefaultLivePort);
  }
}

void declare_run_options(CLI::App& app, Options& options) {
  app.add_option("SCENE.xml", options.scene, "the scene to run");
  app.add_option("--frames", options.frames, "how many frames; with a trajectory by default all until its end")
      ->type_name("N")
      ->check(whole_number)
      ->capture_default_str();
  app.add_option("--rate", options.rate, "frames per simulated second; auto: a frame exactly when a sensor is due")
      ->type_name("HZ|auto")
      ->capture_default_str();
  app.add_option("--set", options.set, "a parameter, from the first frame on (repeatable)")
      ->type_name("ELEMENT.PARAM=VALUE")
      ->allow_extra_args(false);
  app.add_option("--trajectory", options.trajectory,
                 "parameters over time: first column time_s, further columns ELEMENT.PARAM; linear between rows, "
                 "angles the short way")
      ->type_name("FILE.csv");
  app.add_option("--seed", options.seed, "seed of all random numbers")
      ->type_name("N")
      ->check(whole_number)
      ->capture_default_str();
  app.add_option("--device", options.device,
                 "the Vulkan device to use: part of its name, its index, or \"bundled\" for that "
                 "of the driver that SimVis was built with")
      ->type_name("NAME|INDEX");
  app.add_option(
         "--threads", options.threads,
         "number of threads on which SimVis casts rays, culls views and prepares meshes, up to 1024; 0: one for each "
         "core. Up to 8 more threads of low priority encode pictures, none with 1. Results do not depend on the "
         "number. The Vulkan driver has threads of its own")
      ->type_name("N")
      ->check(whole_number)
      ->capture_default_str();
  app.add_option("--plugin", options.plugins, "a library with more elements and sensors (repeatable)")
      ->type_name("FILE.so")
      ->allow_extra_args(false);
  app.add_option("--package", options.packages,
                 "the folder of a ROS package or Gazebo model that parts name, searched first (repeatable)")
      ->type_name("NAME=DIR")
      ->allow_extra_args(false);
  app.add_flag("--strict", options.strict, "warnings are errors");
  app.add_flag("--quiet", options.quiet, "print errors and warnings only");
}

void declare_sensor_options(CLI::App& app, Options& options) {
  app.add_option("--sensor", options.sensors, "run only this sensor (repeatable)")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option("--method", options.method, "scan method of every laser scanner, in place of the scene's own")
      ->type_name("M")
      ->check(not_empty);
  app.add_option("--max-error", options.max_error_m,
                 "bound on the error of every laser scanner's ranges, in metres; by method hybrid unless --method says "
                 "auto")
      ->type_name("M")
      ->check(not_empty);
}

void declare_result_options(CLI::App& app, Options& options) {
  app.add_option("-o,--out", options.out, "where results go")->type_name("DIR")->capture_default_str();
  app.add_option(
         "--format", options.formats,
         "file formats: color=png,jpeg,exr depth=exr,png,npy scan=csv,npy,npz,ply,pcd,bin; a name without a kind "
         "counts for every kind that has it (repeatable; default: color=png depth=exr scan=csv)")
      ->type_name("[KIND=]NAME,...")
      ->allow_extra_args(false);
  app.add_option("--depth-unit", options.depth_unit_m, "metres per code of depth as PNG")
      ->type_name("M")
      ->check(above_zero())
      ->capture_default_str();
  app.add_option("--poses", options.poses,
                 "also write where this part, or another insertion point, stands in each frame (repeatable)")
      ->type_name("PART")
      ->allow_extra_args(false);
  CLI::Option* const record =
      app.add_option("--record", options.record,
                     "also write the frames of this run as ROS 2 messages to an MCAP file; docs/messages.md lists them")
          ->type_name("FILE.mcap")
          ->check(not_empty);
  app.add_option("--record-topics", options.record_topics,
                 "with --record: only topics that match a pattern with * and ? (repeatable)")
      ->type_name("PATTERN,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(not_empty)
      ->needs(record);
  app.add_option("--record-policy", options.record_policy,
                 "with --record, when writing is slower than the simulation: wait, or drop measurements and count them")
      ->type_name("wait|drop")
      ->check(CLI::IsMember({"wait", "drop"}))
      ->capture_default_str()
      ->needs(record);
  app.add_option("--record-pcap", options.record_pcap,
                 "also write the data packets that the laser scanner would send to a capture file; "
                 "docs/device-packets.md names the devices")
      ->type_name("[SENSOR=]FILE.pcap")
      ->check(not_empty);
  app.add_option("--udp", options.udp, "also send the data packets that the laser scanner would send to this host")
      ->type_name("[SENSOR=]HOST[:PORT]")
      ->check(not_empty);
  app.add_option("--export", options.export_file,
                 "also write the scene, as it stands in the last frame, as glTF: parts, materials, textures and lights")
      ->type_name("FILE.glb")
      ->check(not_empty);
  app.add_option("--page", options.page,
                 "also write the frames of this run to one HTML file, which shows them in a browser without a server; "
                 "docs/live-view.md says what it shows")
      ->type_name("FILE.html")
      ->check(not_empty);
  app.add_option("--profile", options.profile,
                 "write what each frame spent its time on, on the host and on the device, in Chrome's trace format")
      ->type_name("FILE.json");
  app.add_option("--shard", options.shard,
                 "only the frames k with k mod N = K; files are those of the whole run, tables and run.json have "
                 "-K-of-N in their names")
      ->type_name("K/N")
      ->check(not_empty);
  app.add_flag("--resume", options.resume,
               "go on with the run in DIR where it ended; the command line is that of the run, or only --out");
  app.add_flag("--no-replace", options.no_replace, "refuse to replace the results of an earlier run in DIR");
  app.add_option("--again", options.again,
                 "make the run again that this run.json describes, from the same files, into --out")
      ->type_name("RUN.json");
}

void declare_report_options(CLI::App& app, Options& options) {
  app.add_flag("--explain", options.explain, "print what the last frame renders, why, and what it cost");
  app.add_flag(
      "--summary", options.summary,
      "after the run, print the speed of the laser scanners, the share of a frame that the other sensors take, "
      "what each method costs the first scanner and how large its error is, and which files to open first");
  app.add_flag(
      "--price", options.price,
      "print what each method of each laser scanner and each max_error_px of each camera costs and is worth in "
      "this scene; --frames of each (" +
          std::to_string(PriceDesc().frames) +
          "), along the trajectory if there is one; also as DIR/price.csv and DIR/camera_price.csv "
          "where --out is given");
}

// Options that cannot stand together: the first one and any of the others.
struct Exclusion {
  const char* option;
  std::vector<const char*> others;
};

void declare_exclusions(CLI::App& app) {
  const Exclusion exclusions[] = {
      {"--price",
       {"--method", "--profile", "--shard", "--record", "--record-pcap", "--udp", "--export", "--page", "--explain",
        "--summary", "--resume", "--again", "--serve", "--follow", "--dds", "--live"}},
      {"--shard", {"--summary", "--serve", "--follow", "--dds", "--live"}},
      {"--resume", {"--no-replace", "--again", "--serve", "--follow", "--dds", "--live"}},
      {"--again", {"--serve", "--follow", "--dds", "--live"}},
      {"--follow", {"--set", "--trajectory", "--sensor", "--poses", "--serve"}},
      {"--summary", {"--quiet"}},
      {"--list",
       {"--check", "--list-types", "--set", "--trajectory", "--sensor", "--price", "--summary", "--explain",
        "--profile", "--shard"}},
      {"--check", {"--set", "--trajectory", "--sensor", "--price", "--summary", "--explain", "--profile", "--shard"}},
  };
  for (const Exclusion& exclusion : exclusions) {
    for (const char* other : exclusion.others) app.get_option(exclusion.option)->excludes(app.get_option(other));
  }
}

// Gives this title in --help to the options that were declared since the last call.
void name_group(CLI::App& app, const std::string& title) {
  for (CLI::Option* const option : app.get_options()) {
    if (option->get_group() == kUnnamedGroup) option->group(title);
  }
}

void declare_information_options(CLI::App& app, Options& options) {
  CLI::Option* const describe =
      app.add_option(
             "--describe", options.describe,
             "print what a type of element, sensor or effect, or a command of a scene does, and its attributes, and "
             "exit; all: every type")
          ->type_name("TYPE");
  app.add_flag("--markdown", options.markdown, "with --describe: as Markdown")->needs(describe);
  declare_list_options(app, options.list);
  app.add_flag("--list-devices", options.list_devices, "print the Vulkan devices of this machine, and exit");
  app.set_version_flag("--version", "simvis-run " + std::string(version()), "print the version, and exit");
  app.set_help_flag("-h,--help", "print this help, and exit");
}

void declare_options(CLI::App& app, Options& options) {
  declare_run_options(app, options);
  name_group(app, "The run");
  declare_sensor_options(app, options);
  name_group(app, "Sensors");
  declare_result_options(app, options);
  name_group(app, "Results");
  declare_report_options(app, options);
  name_group(app, "Reports on a run");
  declare_serve_options(app, options);
  declare_dds_options(app, options);
  declare_live_options(app, options);
  name_group(app, "Other processes and machines");
  declare_information_options(app, options);
  name_group(app, "Instead of a run");
  declare_exclusions(app);
  app.footer(
      "Results: DIR/CAMERA/000000.png and .exr, DIR/SCANNER.csv, DIR/SENSOR_poses.csv, DIR/run.json.\n"
      "Exit status: 0 done; 1 it could not be done; 2 the command line or the scene is wrong;\n"
      "130 stopped by a signal.");
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

void read_rate(Options& options) {
  options.frames_when_due = options.rate == "auto";
  if (options.frames_when_due || parse_number(options.rate, options.rate_hz)) return;
  throw InputError("--rate: " + in_quotes(options.rate) + " is not allowed, expected a number (Hz) or auto");
}

/// Options that may stand beside --again: they change no byte of the results.
constexpr std::string_view kFreeOptions[] = {
    "--again",         "--resume",        "--out",         "--quiet",   "--threads", "--device",
    "--no-replace",    "--frames",        "--explain",     "--profile", "--summary", "--record",
    "--record-topics", "--record-policy", "--record-pcap", "--udp",     "--export",  "--page"};

void require_free_options(const CLI::App& app, const char* with) {
  for (const CLI::Option* const option : app.get_options()) {
    if (option->count() == 0) continue;
    const std::string name = option->get_name();
    const bool allowed = std::ranges::count(kFreeOptions, std::string_view(name)) > 0;
    if (allowed && !(name == "--frames" && std::string_view(with) == "--again")) continue;
    throw InputError(std::string(with) + ": " + name + " is fixed by the run, expected it without");
  }
}

}  // namespace

ParsedOptions parse_options(std::vector<std::string> arguments) {
  ParsedOptions parsed;
  Options& options = parsed.options;
  options.command = arguments;
  CLI::App app("Simulates what a robot's optical sensors see.", "simvis-run");
  app.formatter(std::make_shared<HelpFormatter>());
  declare_options(app, options);
  give_default_port(arguments);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::Success& wish) {
    parsed.exit_status = app.exit(wish);
    return parsed;
  } catch (const CLI::ParseError& error) {
    throw InputError(unknown_option(app).value_or(error.what()) + "; see --help");
  }
  options.names_out = app.count("--out") > 0;
  options.names_frames = app.count("--frames") > 0;
  options.dds = app.count("--dds") > 0;
  double domain = 0;
  if (options.scene.empty() && !parse_number(options.dds_domain, domain)) {
    std::swap(options.scene, options.dds_domain);  // --dds SCENE.xml
  }
  if (!options.allow.empty() && options.serve.empty() && !options.dds && !options.live) {
    throw InputError("--allow requires --serve, --dds or --live; see --help");
  }
  const bool is_live = !options.serve.empty() || !options.follow.empty() || options.live || options.dds;
  options.endless = is_live && !options.names_frames && options.trajectory.empty();
  options.writes = !options.live || options.names_out;
  read_rate(options);
  if (!options.again.empty()) require_free_options(app, "--again");
  if (options.resume && options.scene.empty()) require_free_options(app, "--resume");
  return parsed;
}

Options recorded_options(const Options& given) {
  const bool again = !given.again.empty();
  const EarlierRun run =
      read_report(again ? std::filesystem::path(given.again) : std::filesystem::path(given.out) / "run.json");
  if (run.command.empty()) throw InputError(run.report.string() + ": error: holds no command line");
  set_environment(run.environment);
  ParsedOptions recorded = parse_options(run.command);
  Options options = recorded.options;
  if (!options.serve.empty() || !options.follow.empty() || options.live || options.dds) {
    throw InputError(run.report.string() + ": error: other processes took part in the run, which is not recorded");
  }
  if (!options.again.empty() || options.scene.empty()) {
    throw InputError(run.report.string() + ": error: its command line names no scene");
  }
  options.again = given.again;
  options.out = given.out;
  options.quiet = given.quiet;
  options.threads = given.threads;
  options.no_replace = given.no_replace;
  options.resume = given.resume;
  options.explain = given.explain;
  options.profile = given.profile;
  options.summary = given.summary;
  options.record = given.record;
  options.record_topics = given.record_topics;
  options.record_policy = given.record_policy;
  options.record_pcap = given.record_pcap;
  options.udp = given.udp;
  options.export_file = given.export_file;
  options.page = given.page;
  if (!given.device.empty()) options.device = given.device;
  options.names_frames |= given.names_frames;
  options.frames = given.names_frames ? given.frames : run.frames_wanted;
  return options;
}

}  // namespace simvis
