#include "program/report/earlier_run.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include <simvis/error.h>
#include "engine/base/file_pieces.h"
#include "engine/base/file_writing.h"
#include "engine/base/sha256.h"
#include "program/output/pose_files.h"
#include "scenegraph/language/json_text.h"

namespace simvis {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDependsOn[] = {"scene", "seed",    "rate_hz", "set",    "trajectory", "inputs",
                                      "shard", "formats", "poses",   "device", "driver",     "versions"};

/// Many times what a report has.
constexpr std::size_t kMaxReportBytes = std::size_t{64} << 20;
/// A report has five. Deeper nesting would exhaust the stack.
constexpr int kMaxReportDepth = 32;

std::string read_text_of(const std::filesystem::path& file) {
  std::string text;
  read_in_pieces(file, [&](std::span<const std::uint8_t> piece) {
    if (text.size() + piece.size() > kMaxReportBytes) {
      throw InputError(file.string() + ": error: has more than " + std::to_string(kMaxReportBytes >> 20) +
                       " MiB, expected a run.json that simvis-run wrote");
    }
    text.append(piece.begin(), piece.end());
  });
  return text;
}

[[noreturn]] void refuse_report(const std::filesystem::path& report) {
  throw InputError(report.string() + ": error: is no report of a run, expected a run.json that simvis-run wrote");
}

Json parse_report(const std::string& text, const std::filesystem::path& report) {
  return Json::parse(text, [&](int depth, Json::parse_event_t, const Json&) {
    if (depth > kMaxReportDepth) refuse_report(report);
    return true;
  });
}

/// The bytes of names in a report. None holds a zero byte, at which a call of the system would end the name.
class RecordedTexts {
 public:
  explicit RecordedTexts(const std::filesystem::path& report) : report_(report) {}

  std::string one(const Json& text) const {
    std::string bytes = from_json_text(text.get_ref<const std::string&>());
    if (bytes.find('\0') != std::string::npos) refuse_report(report_);
    return bytes;
  }
  std::vector<std::string> list(const Json& texts) const {
    std::vector<std::string> all;
    for (const Json& each : texts.get_ref<const Json::array_t&>()) all.push_back(one(each));
    return all;
  }
  template <typename Value, typename Read>
  std::map<std::string, Value> map(const Json& json, const Read& read) const {
    std::map<std::string, Value> all;
    for (const auto& [name, value] : json.get_ref<const Json::object_t&>()) all[one(name)] = read(value);
    return all;
  }

 private:
  const std::filesystem::path& report_;
};

/// A name from a report leads to a file below the folder of the run.
bool stays_below(const std::filesystem::path& name) {
  return !name.empty() && name.is_relative() &&
         std::ranges::none_of(name, [](const auto& each) { return each == ".." || each == "." || each.empty(); });
}

std::map<std::string, std::string> depends_on(const Json& json) {
  std::map<std::string, std::string> result;
  for (const char* key : kDependsOn) {
    if (json.contains(key)) result[key] = json[key].dump();
  }
  const Json sensors = json.value("sensors", Json::object());
  for (const auto& [name, sensor] : sensors.items()) {
    result["sensors." + name] =
        sensor.value("attributes", Json()).dump() + (sensor.value("enabled", true) ? "" : " off");
  }
  return result;
}

// Null in the report of a run that had no last frame.
std::uint64_t frames_wanted(const Json& json) {
  const auto found = json.find("frames_wanted");
  return found == json.end() || found->is_null() ? 0 : found->get<std::uint64_t>();
}

std::filesystem::path folder_of(const EarlierRun& run) {
  const std::filesystem::path folder = run.report.parent_path();
  return folder.empty() ? "." : folder;
}

std::filesystem::path pose_table_of(const EarlierRun& run, const std::string& name, const std::string& suffix) {
  return pose_csv(run.report.parent_path() / (name + "_poses" + suffix));
}

}  // namespace

std::map<std::string, std::string> depends_on(const std::string& report_json) {
  return depends_on(Json::parse(report_json));
}

EarlierRun read_report(const std::filesystem::path& report) {
  const std::string text = read_text_of(report);
  const RecordedTexts texts(report);
  try {
    const Json json = parse_report(text, report);
    json.at("versions").at("simvis");  // throws for other files of this name
    const auto one = [&](const Json& value) { return texts.one(value); };
    EarlierRun run{.report = report,
                   .status = json.value("status", ""),
                   .frames_wanted = frames_wanted(json),
                   .next_frame = json.value("next_frame", std::uint64_t{0}),
                   .command = texts.list(json.value("command", Json::array())),
                   .inputs = texts.map<std::string>(json.value("inputs", Json::object()), one),
                   .environment = texts.map<std::optional<std::string>>(
                       json.value("environment", Json::object()),
                       [&](const Json& value) { return value.is_null() ? std::nullopt : std::optional(one(value)); }),
                   .files = texts.map<std::vector<std::string>>(json.value("files", Json::object()),
                                                                [&](const Json& value) { return texts.list(value); }),
                   .depends = depends_on(json)};
    for (const auto& [name, files] : run.files) {
      if (!stays_below(name)) throw InputError(report.string() + ": error: \"" + name + "\" is no sensor of a run");
      for (const std::string& file : files) {
        if (!stays_below(file)) throw InputError(report.string() + ": error: \"" + file + "\" is no file of a run");
      }
    }
    return run;
  } catch (const Json::exception&) {
    refuse_report(report);
  }
}

std::optional<EarlierRun> find_earlier_run(const std::filesystem::path& report) {
  std::error_code error;
  if (!std::filesystem::exists(report, error)) return std::nullopt;
  return read_report(report);
}

void require_own_files(const EarlierRun& run) {
  const std::filesystem::path root = std::filesystem::weakly_canonical(folder_of(run));
  for (const auto& [name, files] : run.files) {
    for (const std::string& file : files) {
      const std::filesystem::path folder = (folder_of(run) / file).parent_path();
      const std::filesystem::path below = std::filesystem::weakly_canonical(folder).lexically_relative(root);
      if (!below.empty() && *below.begin() != "..") continue;
      throw InputError(folder.string() + ": error: is a link that leads out of " + folder_of(run).string() +
                       ", expected another --out, or that it is removed");
    }
  }
}

std::vector<std::filesystem::path> written_files(const EarlierRun& run, const std::string& suffix) {
  const std::filesystem::path folder = run.report.parent_path();
  std::vector<std::filesystem::path> others, poses;
  for (const auto& [name, files] : run.files) {
    const std::filesystem::path table = pose_table_of(run, name, suffix);
    const std::vector<std::uint64_t> frames = frames_of(table);
    for (const std::string& file : files) {
      const std::filesystem::path path = folder / file;
      if (path.stem() == "*") {
        for (const std::uint64_t frame : frames) {
          others.push_back(path.parent_path() / (frame_name(frame) + path.extension().string()));
        }
      } else {
        (path.stem() == table.stem() ? poses : others).push_back(path);
      }
    }
  }
  others.insert(others.end(), poses.begin(), poses.end());
  return others;
}

std::size_t remove_results(const EarlierRun& run, const std::string& suffix) {
  std::size_t removed = 0;
  std::set<std::filesystem::path> folders;
  std::error_code error;
  const auto remove = [&](const std::filesystem::path& file) {
    removed += std::filesystem::remove(file, error) ? 1 : 0;
    if (error) throw_file_error(file, "cannot be removed", error.value());
  };
  for (const std::filesystem::path& file : written_files(run, suffix)) {
    remove(file);
    folders.insert(file.parent_path());
  }
  folders.erase(run.report.parent_path());
  for (const std::filesystem::path& folder : folders) {
    std::filesystem::remove(folder, error);  // fails if something else lies in it
  }
  remove(run.report);
  return removed;
}

std::uint64_t first_missing_frame(const EarlierRun& run, const std::string& suffix) {
  if (run.status == "complete" || run.status == "stopped") return run.next_frame;
  std::uint64_t last = 0;
  for (const auto& [name, files] : run.files) {
    const std::vector<std::uint64_t> frames = frames_of(pose_table_of(run, name, suffix));
    if (!frames.empty()) last = std::max(last, frames.back());
  }
  return last;
}

void require_same_inputs(const EarlierRun& run) {
  for (const auto& [file, recorded] : run.inputs) {
    const std::string now = sha256_of(file);
    if (now == recorded) continue;
    throw InputError(file + ": error: has changed: its SHA-256 is " + now + ", expected " + recorded + " as in " +
                     run.report.string());
  }
}

void require_same_run(const EarlierRun& run, const std::map<std::string, std::string>& depends) {
  std::set<std::string> keys;
  for (const auto* const all : {&run.depends, &depends}) {
    for (const auto& [key, value] : *all) keys.insert(key);
  }
  const auto text = [](const std::map<std::string, std::string>& all, const std::string& key) {
    const auto found = all.find(key);
    return found == all.end() ? std::string("nothing") : found->second;
  };
  for (const std::string& key : keys) {
    if (text(run.depends, key) == text(depends, key)) continue;
    throw InputError("the run in " + run.report.string() + " was made with another \"" + key +
                     "\": " + text(run.depends, key) + ", and this one has " + text(depends, key));
  }
}

}  // namespace simvis
