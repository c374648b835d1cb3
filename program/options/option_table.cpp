#include "program/options/option_table.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <simvis/effect.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "program/datasets/dataset_format.h"
#include "program/options/settings.h"
#include "program/output/formats.h"
#include "program/report/command_reference.h"
#include "program/report/cost_desc.h"

namespace simvis {
namespace {

using Group = OptionGroup;
using Check = OptionCheck;

template <auto member>
OptionTarget at(Options& options) {
  return &(options.*member);
}

template <auto member>
OptionTarget in_list(Options& options) {
  return &(options.list.*member);
}

std::string in_words(const std::set<std::string_view>& names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : " ") + std::string(name);
  return text;
}

/// The names of all formats, without their kinds.
std::string format_names() {
  std::set<std::string_view> names;
  for (const FormatSpec& format : format_table()) names.insert(format.name);
  return in_words(names);
}

std::string scan_methods() {
  const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type("laser_scanner"));
  return std::string(std::ranges::find(table, "method", &AttributeSpec::name)->choices);
}

std::string described_types() {
  std::set<std::string_view> names{"all", "presets"};
  for (const CommandForm& form : command_forms()) names.insert(form.name);
  for (const ElementType* const type : element_types()) names.insert(type->name);
  for (const SensorType* const type : sensor_types()) names.insert(type->name);
  for (const EffectType* const type : effect_types()) names.insert(type->name);
  return in_words(names);
}

constexpr OptionSpec kOptions[] = {
    {.group = Group::run,
     .names = "--frames",
     .target = at<&Options::frames>,
     .value = "N",
     .text = "how many frames; with a trajectory by default all until its end",
     .check = Check::whole,
     .changes_no_result = true},
    {.group = Group::run,
     .names = "--rate",
     .target = at<&Options::rate>,
     .value = "HZ|auto",
     .setting = "rate_hz",
     .absent_word = "auto",
     .more = ", see [below](#frames-and-rates)"},
    {.group = Group::run,
     .names = "--set",
     .target = at<&Options::set>,
     .value = "ELEMENT.PARAM=VALUE",
     .text = "a parameter, from the first frame on"},
    {.group = Group::run,
     .names = "--trajectory",
     .target = at<&Options::trajectory>,
     .value = "FILE.csv",
     .text = "parameters over time: first column `time_s`, further columns `ELEMENT.PARAM`; linear between rows, "
             "angles the short way. `ELEMENT.qx`, `.qy`, `.qz`, `.qw` give an orientation as quaternion"},
    {.group = Group::run,
     .names = "--restore-state",
     .target = at<&Options::restore_state>,
     .value = "FILE",
     .text =
         "go on from the state that `--save-state` wrote for the same scene and settings; `--set` comes after it, and "
         "sensors are on that were on",
     .more = ", see [saved state](dynamics.md#saved-state)",
     .check = Check::not_empty},
    {.group = Group::run, .names = "--seed", .value = "N", .setting = "seed", .check = Check::whole},
    {.group = Group::run, .names = "--device", .value = "NAME|INDEX", .setting = "device", .changes_no_result = true},
    {.group = Group::run,
     .names = "--threads",
     .value = "N",
     .setting = "threads",
     .more = ": those of lavapipe are set by the environment variable `LP_NUM_THREADS`. Up to 8 more threads of low "
             "priority encode pictures, none with 1",
     .check = Check::whole,
     .changes_no_result = true},
    {.group = Group::run,
     .names = "--plugin",
     .target = at<&Options::plugins>,
     .value = "FILE.so",
     .text = "a library with more elements and sensors"},
    {.group = Group::run,
     .names = "--package",
     .target = at<&Options::packages>,
     .value = "NAME=DIR",
     .setting = "packages"},
    {.group = Group::run, .names = "--strict", .setting = "strict"},
    {.group = Group::run,
     .names = "--quiet",
     .target = at<&Options::quiet>,
     .text = "print errors and warnings only",
     .changes_no_result = true},

    {.group = Group::sensors,
     .names = "--sensor",
     .target = at<&Options::sensors>,
     .value = "NAME",
     .text = "run only this sensor"},
    {.group = Group::sensors,
     .names = "--method",
     .target = at<&Options::method>,
     .value = "M",
     .text = "scan method of every laser scanner, in place of the scene's own",
     .choices = &scan_methods,
     .check = Check::not_empty},
    {.group = Group::sensors,
     .names = "--max-error",
     .target = at<&Options::max_error_m>,
     .value = "M",
     .text = "bound on the error of every laser scanner's ranges, in metres; by method `hybrid` unless `--method` "
             "says `auto`",
     .check = Check::not_empty},

    {.group = Group::results,
     .names = "-o,--out",
     .target = at<&Options::out>,
     .value = "DIR",
     .text = "where results go",
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--dataset",
     .target = at<&Options::datasets>,
     .value = "FORMAT,...",
     .text = "write a dataset of this format to `DIR` in place of the files of a run; of several formats each to "
             "`DIR/FORMAT`",
     .facts = [] { return dataset_names(", "); },
     .choices = [] { return dataset_names(" "); },
     .more = ", see [datasets](datasets.md)",
     .check = Check::not_empty,
     .splits_at_commas = true},
    {.group = Group::results,
     .names = "--format",
     .target = at<&Options::formats>,
     .value = "[KIND=]NAME,...",
     .text = "output formats; png without a kind means color=png and depth=png",
     .facts = [] { return describe_formats(); },
     .choices = &format_names},
    {.group = Group::results,
     .names = "--depth-unit",
     .target = at<&Options::depth_unit_m>,
     .value = "M",
     .text = "metres per code of depth as 16-bit PNG",
     .check = Check::above_zero},
    {.group = Group::results,
     .names = "--poses",
     .target = at<&Options::poses>,
     .value = "PART",
     .text = "also write where this part, or another insertion point, stands in each frame"},
    {.group = Group::results,
     .names = "--record",
     .target = at<&Options::record>,
     .value = "FILE.mcap|BAG/",
     .text = "also write the frames of this run as ROS 2 messages to an MCAP file, or to a bag folder of ROS 2",
     .more = ", see [messages](messages.md)",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--record-topics",
     .target = at<&Options::record_topics>,
     .value = "PATTERN,...",
     .text = "only topics that match a pattern with `*` and `?`",
     .needs = "--record",
     .check = Check::not_empty,
     .splits_at_commas = true,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--record-policy",
     .target = at<&Options::record_policy>,
     .value = "wait|drop",
     .text = "what a frame does when writing is slower than the simulation: wait, or drop measurements and count them",
     .needs = "--record",
     .check = Check::one_of,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--record-pcap",
     .target = at<&Options::record_pcap>,
     .value = "[SENSOR=]FILE.pcap",
     .text = "also write the data packets that the laser scanner would send to a capture file; given several times for "
             "several scanners",
     .more = ", see [device packets](device-packets.md)",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--udp",
     .target = at<&Options::udp>,
     .value = "[SENSOR=]HOST[:PORT]",
     .text = "also send the data packets that the laser scanner would send to this host",
     .more = ", see [device packets](device-packets.md)",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--export",
     .target = at<&Options::export_file>,
     .value = "FILE.glb|FILE.yaml|FILE.npz|FILE.bt",
     .text =
         "also write the scene, as it stands in the last frame: as glTF (`.glb`) with parts, materials, textures and "
         "lights; as a map of ROS (`.yaml` with a picture `.pgm`), or as a voxel grid for NumPy (`.npz`) or OctoMap "
         "(`.bt`)",
     .more = ", see [live view](live-view.md#the-export) and [maps](maps.md)",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--export-resolution",
     .target = at<&Options::export_resolution_m>,
     .value = "M",
     .text = "side of a cell of a map, in metres",
     .needs = "--export",
     .check = Check::above_zero,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--export-heights",
     .target = at<&Options::export_heights>,
     .value = "LOW,HIGH",
     .text = "a map has what lies between these heights, in metres; otherwise between 0.1 and 1 in a map of ROS, and "
             "everything in a voxel grid",
     .needs = "--export",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--export-area",
     .target = at<&Options::export_area>,
     .value = "X0,Y0,X1,Y1",
     .text = "a map reaches from these coordinates to those, in metres; otherwise around all shapes",
     .needs = "--export",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--export-start",
     .target = at<&Options::export_start>,
     .value = "X,Y[,Z]",
     .text = "cells of a map that cannot be reached from here are unknown; otherwise all are free that "
             "are not occupied",
     .needs = "--export",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--export-ignore",
     .target = at<&Options::export_ignore>,
     .value = "NAME,...",
     .text = "a map leaves out these parts, links or models, such as the robot; names, paths or "
             "patterns, as in the attribute `ignore` of sensors",
     .needs = "--export",
     .check = Check::not_empty,
     .splits_at_commas = true,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--save-state",
     .target = at<&Options::save_state>,
     .value = "FILE",
     .text = "also write the state of the simulation after the last frame",
     .more = ", see [saved state](dynamics.md#saved-state)",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--page",
     .target = at<&Options::page>,
     .value = "FILE.html",
     .text = "also write the frames of this run to one HTML file, which shows them in a browser without a server",
     .more = ", see [live view](live-view.md)",
     .check = Check::not_empty,
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--profile",
     .target = at<&Options::profile>,
     .value = "FILE.json",
     .text = "write what each frame spent its time on, on the host and on the device, in Chrome's trace format",
     .more = " (chrome://tracing, ui.perfetto.dev)",
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--shard",
     .target = at<&Options::shard>,
     .value = "K/N",
     .text = "only the frames k with k mod N = K; files are those of the whole run, tables and run.json have `-K-of-N` "
             "in their names",
     .check = Check::not_empty},
    {.group = Group::results,
     .names = "--resume",
     .target = at<&Options::resume>,
     .text = "go on with the run in `DIR` where it ended; the command line is that of the run, or only `--out`",
     .more = ". Without an earlier run it begins from the start",
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--no-replace",
     .target = at<&Options::no_replace>,
     .text = "refuse to replace the results of an earlier run in `DIR`, and files of other options",
     .changes_no_result = true},
    {.group = Group::results,
     .names = "--again",
     .target = at<&Options::again>,
     .value = "RUN.json",
     .text = "make the run again that this `run.json` describes, from the same files, into `--out`",
     .changes_no_result = true},

    {.group = Group::reports,
     .names = "--explain",
     .target = at<&Options::explain>,
     .text = "print what the last frame renders, why, and what it cost, and what was loaded and why",
     .changes_no_result = true},
    {.group = Group::reports,
     .names = "--summary",
     .target = at<&Options::summary>,
     .text = "after the run, print the speed of the laser scanners, the share of a frame that the other sensors take, "
             "what each method costs the first scanner and how large its error is, and which files to open first",
     .changes_no_result = true},
    {.group = Group::reports,
     .names = "--price",
     .target = at<&Options::price>,
     .text = "print what each method of each laser scanner, and each `max_error_px` and each kind of light of each "
             "camera, costs and is worth in this scene, over `--frames` frames, along the trajectory if there is one; "
             "also as `DIR/price.csv`, `DIR/camera_price.csv` and `DIR/light_price.csv` where `--out` is given; "
             "`--sensor` chooses some of them",
     .facts = [] { return std::to_string(CostDesc().frames) + " frames by default"; }},
    {.group = Group::reports,
     .names = "--compare",
     .target = at<&Options::compare>,
     .value = "FILE.pcap|FILE.mcap",
     .text =
         "in place of a run, compare the recording of a real laser scanner, `.pcap` or `.mcap`, with the same scanner "
         "of the scene: angles of each ring, bias and noise of ranges, intensity, lost beams, with intervals of 95 %; "
         "of the first `--frames` scans; also as `DIR/fidelity.json` and `DIR/fidelity.svg` where `--out` is given; "
         "`--sensor` chooses the scanner",
     .facts = [] { return std::to_string(kComparedScans) + " scans by default"; },
     .more = ", see [fidelity](fidelity.md)",
     .check = Check::not_empty},
    {.group = Group::reports,
     .names = "--compare-topic",
     .target = at<&Options::compare_topic>,
     .value = "TOPIC",
     .text = "the topic of an `.mcap` file that has several with scans",
     .needs = "--compare",
     .check = Check::not_empty},
    {.group = Group::reports,
     .names = "--fit-pose",
     .target = at<&Options::fit_pose>,
     .text = "fit the sensor's position and tilt too; otherwise its pose in the scene counts as exact",
     .needs = "--compare"},

    {.group = Group::processes,
     .names = "--serve",
     .target = at<&Options::serve>,
     .value = "NAME",
     .text = "let other processes read and write the running simulation under this name; without `--frames` "
             "and `--trajectory` it goes on until it is interrupted",
     .more = ", see [shared-memory.md](shared-memory.md)",
     .check = Check::not_empty},
    {.group = Group::processes,
     .names = "--serve-group",
     .target = at<&Options::serve_group>,
     .text = "programs with this process's effective group may connect too, not those of its user alone",
     .needs = "--serve"},
    {.group = Group::processes,
     .names = "--allow",
     .target = at<&Options::allow>,
     .value = "DIR",
     .text = "requests of clients may name files below this folder, and relative names start at the first; without it "
             "the scene's folder",
     .needs = "--serve --dds-requests --live"},
    {.group = Group::processes,
     .names = "--lockstep",
     .target = at<&Options::lockstep>,
     .value = "CLIENT,...",
     .text = "each frame waits until these clients are ready for it",
     .needs = "--serve",
     .splits_at_commas = true},
    {.group = Group::processes,
     .names = "--lockstep-timeout",
     .target = at<&Options::lockstep_timeout_s>,
     .value = "S",
     .text = "the run ends with status 1 if a client is not ready after so many seconds",
     .needs = "--lockstep",
     .check = Check::above_zero},
    {.group = Group::processes,
     .names = "--follow",
     .target = at<&Options::follow>,
     .value = "NAME|dds:[DOMAIN/]NAME",
     .text = "show the simulation that another process serves under this name, on another machine with `dds:` in "
             "front; `SCENE.xml`, which may be missing, has what comes to its scene, such as cameras with "
             "`view=\"visualization\"` and laser beams",
     .more = ", see [below](#followers)",
     .check = Check::not_empty},
    {.group = Group::processes,
     .names = "--real-time",
     .target = at<&Options::real_time>,
     .value = "FACTOR",
     .text = "keep to the wall clock: simulated seconds for each second. A run that is too slow says so and makes all "
             "of its frames, later than they should be",
     .check = Check::above_zero,
     .hides_default = true},
    {.group = Group::processes,
     .names = "--dds",
     .target = at<&Options::dds_domain>,
     .value = "[DOMAIN]",
     .text = "send the frames as ROS 2 messages by DDS, and take values of parameters and commands of robots from "
             "there; without `--frames` and `--trajectory` it goes on until it is interrupted, and without `--out` it "
             "writes no files",
     .more = ", see [messages](messages.md#dds)",
     .is_value_optional = true},
    {.group = Group::processes,
     .names = "--dds-requests",
     .target = at<&Options::dds_requests>,
     .text = "execute change requests of the domain too, which insert and remove parts, elements and sensors, and "
             "services that spawn, pause, step and reset",
     .more = ", see [who may do what](messages.md#who-may-do-what)",
     .needs = "--dds"},
    {.group = Group::processes,
     .names = "--dds-topics",
     .target = at<&Options::dds_topics>,
     .value = "PATTERN,...",
     .text = "only topics that match a pattern with `*` and `?`",
     .needs = "--dds",
     .check = Check::not_empty,
     .splits_at_commas = true},
    {.group = Group::processes,
     .names = "--dds-qos",
     .target = at<&Options::dds_qos>,
     .value = "sensor-data|reliable",
     .text = "what becomes of measurements that the network loses: they stay lost (`sensor-data`), or are sent again "
             "(`reliable`)",
     .needs = "--dds",
     .check = Check::one_of},
    {.group = Group::processes,
     .names = "--dds-node",
     .target = at<&Options::dds_node>,
     .value = "[/NAMESPACE/]NAME",
     .text = "the node of ROS 2 that the simulation is, with its topics `NAME/set`, `NAME/request` and `NAME/log` and "
             "the services of its parameters",
     .more = ", see [robots](ros.md#node-and-parameters)",
     .needs = "--dds"},
    {.group = Group::processes,
     .names = "--live",
     .target = at<&Options::live>,
     .value = "[PORT]",
     .text = "show the running scene in a browser, and to Foxglove, at this port, and print the link; without "
             "`--frames` and `--trajectory` it goes on until it is interrupted, and without `--out` it writes no files",
     .facts = [] { return std::to_string(kDefaultLivePort) + " by default; 0: any free one"; },
     .more = ", see [live-server.md](live-server.md)"},
    {.group = Group::processes,
     .names = "--live-address",
     .target = at<&Options::live_address>,
     .value = "ADDRESS",
     .text = "other machines may connect too, at this address of this one, with the printed link",
     .needs = "--live",
     .check = Check::not_empty},

    {.group = Group::instead_of_run,
     .names = "--describe",
     .target = at<&Options::describe>,
     .value = "TYPE",
     .text = "print what a type of element, sensor or effect, or a command of a scene such as `part`, does, its "
             "attributes and what a sensor gives; `all`: every type; `presets`: every device with a preset",
     .choices = &described_types},
    {.group = Group::instead_of_run,
     .names = "--markdown",
     .target = at<&Options::markdown>,
     .text = "as Markdown",
     .needs = "--describe --help"},
    {.group = Group::instead_of_run,
     .names = "--list",
     .target = in_list<&ListOptions::scene>,
     .text = "print the scene: its parts with their sizes, its elements with their parameters, its sensors and "
             "warnings; needs no device",
     .more = ", so limits of a device are not checked. See [below](#what---list-prints)"},
    {.group = Group::instead_of_run,
     .names = "--check",
     .target = in_list<&ListOptions::check>,
     .text = "print what is probably a mistake in the scene, such as a part of 1,000 m or more, which is in another "
             "unit, or a sensor within a solid; the exit status is 1 if there is any; needs no device"},
    {.group = Group::instead_of_run,
     .names = "--json",
     .target = in_list<&ListOptions::json>,
     .text = "as JSON",
     .needs = "--list --describe"},
    {.group = Group::instead_of_run,
     .names = "--xsd",
     .target = at<&Options::xsd>,
     .text = "the language of scenes as an XML schema, for editors, with `--describe all`",
     .more = ", see [editors](editors.md)",
     .needs = "--describe"},
    {.group = Group::instead_of_run,
     .names = "--list-types",
     .target = in_list<&ListOptions::types>,
     .text = "print every element, sensor and effect type with one line"},
    {.group = Group::instead_of_run,
     .names = "--list-devices",
     .target = at<&Options::list_devices>,
     .text = "print the Vulkan devices of this machine"},
    {.group = Group::instead_of_run,
     .names = "--completion",
     .target = at<&Options::completion>,
     .value = "bash|zsh|fish",
     .text = "print the script by which this shell completes the command line",
     .more = ", see [editors](editors.md#shells)",
     .check = Check::one_of},
    {.group = Group::instead_of_run,
     .names = "--man",
     .target = at<&Options::man>,
     .text = "print this help as a manual page, for `man`"},
    {.group = Group::instead_of_run, .names = "--version", .text = "print the version"},
    {.group = Group::instead_of_run, .names = "-h,--help", .text = "print this help"},
};

constexpr OptionExclusion kExclusions[] = {
    {"--price",
     "--method --profile --shard --record --record-pcap --udp --export --page --explain --summary --resume --again "
     "--serve --follow --dds "
     "--live"},
    {"--compare",
     "--price --trajectory --profile --shard --dataset --format --poses --record --record-pcap --udp --export --page "
     "--explain --summary --resume --again --serve --follow --dds --live"},
    {"--dataset", "--price --no-replace --again --format --poses --serve --follow --dds --live"},
    {"--shard", "--summary --serve --follow --dds --live"},
    {"--resume", "--no-replace --again --serve --follow --dds --live"},
    {"--again", "--serve --follow --dds --live"},
    {"--follow", "--set --trajectory --sensor --poses --serve --export-ignore"},
    {"--summary", "--quiet"},
    {"--restore-state", "--sensor --dataset --shard --resume --follow --compare"},
    {"--save-state", "--price --compare --shard --follow"},
    {"--markdown", "--json --xsd"},
    {"--json", "--xsd"},
    {"--list",
     "--check --list-types --set --trajectory --sensor --price --summary --explain --profile --shard "
     "--save-state --restore-state"},
    {"--check",
     "--set --trajectory --sensor --price --summary --explain --profile --shard --save-state "
     "--restore-state"},
};

}  // namespace

std::span<const OptionSpec> option_table() { return kOptions; }

std::span<const OptionExclusion> option_exclusions() { return kExclusions; }

std::optional<OptionTarget> target_of(const OptionSpec& option, Options& options) {
  if (option.target != nullptr) return option.target(options);
  if (option.setting.empty()) return std::nullopt;
  return std::visit(
      []<typename Field>(Field* field) -> std::optional<OptionTarget> {
        if constexpr (std::is_constructible_v<OptionTarget, Field*>) {
          return field;
        } else {
          return std::nullopt;
        }
      },
      simulation_setting(option.setting).field(options.simulation));
}

}  // namespace simvis
