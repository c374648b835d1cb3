#include <simvis/test_run.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <string_view>
#include <system_error>
#include <variant>

#include <simvis/error.h>
#include <simvis/measurement.h>
#include <simvis/shared_array.h>
#include "program/live/page_recording.h"
#include "simvis/built_scene.h"

namespace simvis::test_kit {
namespace {

double seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) / 1e9; }

/// The absolute name of a scene file. Throws InputError for an empty one.
std::filesystem::path scene_file(const std::filesystem::path& scene) {
  if (scene.empty()) throw InputError("the name of the scene file is empty, expected one");
  return std::filesystem::absolute(scene);
}

/// The name of the folder of a test. Throws InputError for "." and "..", which name other folders.
std::string folder_name(std::string name) {
  for (char& letter : name) {
    if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-' && letter != '.') letter = '_';
  }
  if (name == "." || name == "..") throw InputError("the name of the test is " + name + ", expected that of a folder");
  return name;
}

/// A name as part of a link: bytes other than ASCII letters, digits, '-', '.', '_' and `kept` as %XX.
std::string in_link(std::string_view name, std::string_view kept = {}) {
  constexpr std::string_view kUnreserved = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (const char letter : name) {
    if (kUnreserved.find(letter) != kUnreserved.npos || kept.find(letter) != kept.npos) {
      text += letter;
    } else {
      const auto byte = static_cast<unsigned char>(letter);
      text += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return text;
}

/// Makes a folder NAME, or NAME-2, NAME-3 and so on, that was not there. Throws std::filesystem::filesystem_error.
std::filesystem::path make_new_folder(const std::filesystem::path& root, const std::string& name) {
  std::filesystem::create_directories(root);
  std::filesystem::path folder = root / name;
  for (int number = 2; !std::filesystem::create_directory(folder); ++number) {
    folder = root / (name + "-" + std::to_string(number));
  }
  return folder;
}

bool has_same_numbers(const MeasuredArray& one, const MeasuredArray& other) {
  if (one.count() != other.count()) return false;
  for (std::size_t i = 0; i < one.count(); ++i) {
    const double a = one.number(i), b = other.number(i);
    if (a != b && !(std::isnan(a) && std::isnan(b))) return false;
  }
  return true;
}

/// "SENSOR.OUTPUT", the first output that two simulations measured differently at the same time; empty: there is none.
std::string different_output(const Simulation& one, const Simulation& other) {
  const std::vector<SensorInfo> others = other.sensors();
  for (const SensorInfo& sensor : one.sensors()) {
    if (std::ranges::find(others, sensor.name, &SensorInfo::name) == others.end()) continue;  // it was added later
    const Measurement first = one.measurement(sensor.name), second = other.measurement(sensor.name);
    if (first.time_ns != second.time_ns) continue;  // it was switched off
    for (const MeasuredArray& array : first.arrays) {
      const MeasuredArray* const same = second.find(array.name);
      if (same == nullptr || !has_same_numbers(array, *same)) return sensor.name + "." + array.name;
    }
  }
  return {};
}

}  // namespace

Run::Run(const std::filesystem::path& scene, RunDesc desc)
    : scene_(scene_file(scene)), desc_(std::move(desc)), simulation_(Simulation::load(scene_, desc_.simulation)) {
  if (!(desc_.limit_s > 0)) throw InputError("limit_s is " + detail::number(desc_.limit_s) + ", expected above 0");
  if (desc_.name.empty()) {
    desc_.name = scene_.stem().string() + "-" + std::to_string(desc_.simulation.seed);
  }
  desc_.name = folder_name(std::move(desc_.name));
  const auto values = simulation_.parameters().values();
  before_.assign(values.begin(), values.end());
  changed_.resize(values.size(), false);
}

bool Run::step() {
  const FrameTime next = simulation_.next_frame();
  if (!result_ || static_cast<double>(next.time_ns) > desc_.limit_s * 1e9) return false;
  keep_values(next);
  try {
    simulation_.step();
  } catch (...) {  // if only a consumer of the frame has failed, the frame was made and its values stay
    if (simulation_.next_frame().time_ns == next.time_ns) frames_.pop_back();
    throw;
  }
  const auto values = simulation_.parameters().values();
  before_.assign(values.begin(), values.end());
  for (const auto& [check, name] : checks_) {
    const Verdict verdict = check(simulation_);
    if (!this->check({verdict.ok, (name.empty() ? "" : name + ": ") + verdict.text, verdict.beam})) break;
  }
  return bool(result_);
}

Verdict Run::check(Verdict verdict) {
  if (verdict || !result_) return verdict;
  verdict.text = "at " + detail::number(frames_.empty() ? 0 : seconds(frames_.back().time_ns)) + " s: " + verdict.text;
  result_ = verdict;  // whatever becomes of the evidence
  result_.text += write_evidence(verdict);
  return result_;
}

void Run::keep_values(const FrameTime& next) {
  const auto values = simulation_.parameters().values();
  for (std::size_t i = 0; i < changed_.size(); ++i) changed_[i] = changed_[i] || values[i] != before_[i];
  frames_.push_back({next.time_ns, {values.begin(), values.end()}});
}

/// "&select=beam:SENSOR:BEAM", with which the page selects the beam; empty: it is of no scanner as it stands now.
std::string Run::selection(const JudgedBeam& beam) const {
  if (beam.ranges == nullptr) return {};
  for (const SensorInfo& sensor : simulation_.sensors()) {
    const Measurement measured = simulation_.measurement(sensor.name);
    const MeasuredArray* const ranges = measured.find("range_m");
    const auto* const numbers = ranges == nullptr ? nullptr : std::get_if<SharedArray<float>>(&ranges->numbers);
    if (numbers == nullptr || numbers->data() != beam.ranges) continue;
    return "&select=beam:" + in_link(sensor.name) + ":" + std::to_string(beam.index);
  }
  return {};
}

/// Makes the run again and writes the page and the recording, whose last frame has the failure as a warning. Returns
/// in what it differs: the time of its last frame, or the first output that was measured differently; empty: in
/// nothing.
std::string Run::repeat(const std::filesystem::path& folder, const std::string& failure) const {
  SimulationDesc desc = desc_.simulation;
  desc.strict = false;  // the failure is a warning
  desc.progress = {};
  Simulation again = Simulation::load(scene_, desc);
  read_all_content(again);  // the page shows it
  live::PageRecording page(folder / "failure.html");
  again.record({.file = folder / "failure.mcap", .topics = {}, .drop = false});
  for (const FrameValues& frame : frames_) {
    for (std::size_t i = 0; i < changed_.size(); ++i) {
      if (changed_[i]) again.parameters().set(i, frame.values[i]);
    }
    if (&frame == &frames_.back()) again.warn(failure);
    again.step();
    page.add(again, *again.last_frame());
  }
  again.finish_recording();
  page.finish();
  const std::int64_t last_ns = again.last_frame()->time_ns;
  if (last_ns != frames_.back().time_ns) return "its last frame is at " + detail::number(seconds(last_ns)) + " s";
  return different_output(simulation_, again);
}

/// Returns the lines of the message that name the files, or say why there are none.
std::string Run::write_evidence(const Verdict& failure) const {
  const char* const wanted = std::getenv("SIMVIS_EVIDENCE");
  const bool is_wanted = wanted != nullptr && *wanted != '\0';
  const std::filesystem::path root = !desc_.evidence.empty() ? desc_.evidence : is_wanted ? wanted : "simvis-evidence";
  if (root == "none" || frames_.empty()) return {};
  std::filesystem::path folder;
  const auto none = [&folder](const std::string& why) {
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
    return "\nno evidence: " + why;
  };
  try {
    folder = make_new_folder(std::filesystem::absolute(root), desc_.name);
    const std::string different = repeat(folder, failure.text);
    return (different.empty() ? "" : "\nthe repeated run measured something else: " + different) +
           "\npage:      file://" + in_link((folder / "failure.html").string(), "/") +
           "#frame=" + std::to_string(frames_.size() - 1) + selection(failure.beam) +
           "\nrecording: " + (folder / "failure.mcap").string();
  } catch (const std::exception& failed) {  // the verdict counts more than the evidence
    return none(failed.what());
  } catch (...) {
    return none("an exception of an unknown type");
  }
}

}  // namespace simvis::test_kit
