// A scene under test in C++: it is stepped to a limit, and leaves a page and a recording where a check fails.
#pragma once

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/error.h>
#include <simvis/measurement.h>
#include <simvis/plugin.h>
#include <simvis/shared_array.h>
#include <simvis/simulation.h>
#include <simvis/verdict.h>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace simvis::test_kit {

namespace detail {

/// Nine digits, which tell any two floats apart.
inline std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 9).ptr};
}

/// Three digits, of a bound or a difference.
inline std::string short_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 3).ptr};
}

/// All digits of a double.
inline std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 17).ptr};
}

/// Runs a program of the PATH. Returns why it did not end well; empty: it did.
inline std::string fault_of_program(std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& each : arguments) pointers.push_back(each.data());
  pointers.push_back(nullptr);
  pid_t process = 0;
  const int error = ::posix_spawnp(&process, pointers[0], nullptr, nullptr, pointers.data(), ::environ);
  if (error == ENOENT && arguments[0].find('/') == std::string::npos) return arguments[0] + " is not in the PATH";
  if (error != 0) return arguments[0] + " cannot be started: " + std::generic_category().message(error);
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(process, &status, 0)) == -1 && errno == EINTR) {
  }
  if (ended != process) return "the end of " + arguments[0] + " is not known";
  if (WIFSIGNALED(status)) return arguments[0] + " was ended by signal " + std::to_string(WTERMSIG(status));
  if (WEXITSTATUS(status) == 0) return {};
  return arguments[0] + " ended with status " + std::to_string(WEXITSTATUS(status)) + ", its message stands above";
}

/// The absolute name of a scene file. Throws InputError for an empty one.
inline std::filesystem::path scene_file(const std::filesystem::path& scene) {
  if (scene.empty()) throw InputError("the name of the scene file is empty, expected one");
  return std::filesystem::absolute(scene);
}

/// The name of the folder of a test. Throws InputError for "." and "..", which name other folders.
inline std::string folder_name(std::string name) {
  for (char& letter : name) {
    if (!std::isalnum(static_cast<unsigned char>(letter)) && letter != '-' && letter != '.') letter = '_';
  }
  if (name == "." || name == "..") throw InputError("the name of the test is " + name + ", expected that of a folder");
  return name;
}

/// A name as part of a link: bytes other than letters, digits, '-', '.' and '_' as %XX.
inline std::string in_link(std::string_view name) {
  std::string text;
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    if ((byte < 0x80 && std::isalnum(byte) != 0) || letter == '-' || letter == '.' || letter == '_') {
      text += letter;
      continue;
    }
    constexpr const char* kDigits = "0123456789ABCDEF";
    text += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return text;
}

/// Makes a folder NAME, or NAME-2, NAME-3 and so on, that was not there. Throws std::filesystem::filesystem_error.
inline std::filesystem::path make_new_folder(const std::filesystem::path& root, const std::string& name) {
  std::filesystem::create_directories(root);
  std::filesystem::path folder = root / name;
  for (int number = 2; !std::filesystem::create_directory(folder); ++number) {
    folder = root / (name + "-" + std::to_string(number));
  }
  return folder;
}

}  // namespace detail

/// How a scene is tested.
struct RunDesc {
  double limit_s = 60;          ///< simulated seconds after which the run ends, above 0
  SimulationDesc simulation{};  ///< seed, rate and others, as of Simulation::load()
  /// Folder of pages and recordings of what fails, each in a new folder of its own. Empty: $SIMVIS_EVIDENCE, by default
  /// simvis-evidence; "none": none are written.
  std::filesystem::path evidence{};
  /// Of the test; the folder has this name, or NAME-2, NAME-3 and so on if there is one. Empty: the scene's file name
  /// and the seed.
  std::string name{};
};

/// A simulation that a test steps, frame by frame.
///
/// Evidence  at the first check that fails, simvis-run (that of $SIMVIS_RUN, by default of the PATH) repeats the run,
///           with the values that parameters had in each frame, so passing tests pay nothing for it. It writes
///           failure.html, which any browser opens, failure.mcap, and the files of the run, up to the frame that
///           failed. The page selects the beam of the scan that failed. Types of elements and sensors come along if
///           load_plugin() has loaded them; those that are linked into the test's program do not, and simvis-run then
///           says that it does not know them. Not part of it are SimulationDesc::overrides and elements_move, commands
///           executed during the run, and steps of other lengths than 1 / rate. Values that the scene's elements and
///           the test both set are those of the test.
/// Errors    of Simulation. InputError: the name of the scene file is empty; `limit_s` is not above 0; `name` is "." or
///           "..".
/// Threads   as Simulation.
class Run {
 public:
  /// A property that holds in each frame.
  using Check = std::function<Verdict(const Simulation&)>;

  /// Loads the scene. Throws as Simulation::load(), and InputError as above.
  explicit Run(const std::filesystem::path& scene, RunDesc desc = {})
      : scene_(detail::scene_file(scene)),
        desc_(std::move(desc)),
        simulation_(Simulation::load(scene_, desc_.simulation)) {
    if (!(desc_.limit_s > 0)) throw InputError("limit_s is " + detail::number(desc_.limit_s) + ", expected above 0");
    if (desc_.name.empty()) {
      desc_.name = scene_.stem().string() + "-" + std::to_string(desc_.simulation.seed);
    }
    desc_.name = detail::folder_name(std::move(desc_.name));
    const auto values = simulation_.parameters().values();
    before_.assign(values.begin(), values.end());
    changed_.resize(values.size(), false);
  }

  /// The simulation, to set values and to read measurements. step() of the Run makes its frames.
  Simulation& sim() { return simulation_; }
  /// Checks a property after each frame from now on.
  void always(Check check, std::string name = {}) { checks_.emplace_back(std::move(check), std::move(name)); }

  /// Makes one frame, and false where the limit is reached or a property of always() has failed: result() says which.
  bool step() {
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

  /// Keeps the first verdict that is false, and writes its evidence. Returns the verdict, then with the time and the
  /// files in its text.
  Verdict check(Verdict verdict) {
    if (verdict || !result_) return verdict;
    verdict.text = "at " + detail::number(frames_.empty() ? 0 : frames_.back().time_s) + " s: " + verdict.text;
    result_ = {false, verdict.text + write_evidence(verdict), verdict.beam};
    return result_;
  }

  /// True as long as nothing has failed; then the first verdict that was false.
  const Verdict& result() const { return result_; }

 private:
  struct FrameValues {
    double time_s;
    std::vector<double> values;  // of all parameters, when the frame began
  };

  void keep_values(const FrameTime& next) {
    const auto values = simulation_.parameters().values();
    for (std::size_t i = 0; i < changed_.size(); ++i) changed_[i] = changed_[i] || values[i] != before_[i];
    frames_.push_back({static_cast<double>(next.time_ns) / 1e9, {values.begin(), values.end()}});
  }

  void write_values(const std::filesystem::path& file) const {
    std::ofstream out(file);
    out << "time_s";
    for (std::size_t i = 0; i < changed_.size(); ++i) {
      if (changed_[i]) out << ',' << simulation_.parameters().name(i);
    }
    for (const FrameValues& frame : frames_) {
      out << '\n' << detail::exact(frame.time_s);
      for (std::size_t i = 0; i < changed_.size(); ++i) {
        if (changed_[i]) out << ',' << detail::exact(frame.values[i]);
      }
    }
    out << '\n';
    if (!out.flush()) throw MachineError("cannot write " + file.string());
  }

  /// "&select=beam:SENSOR:BEAM", with which the page selects the beam; empty: it is of no scanner as it stands now.
  std::string selection(const JudgedBeam& beam) const {
    if (beam.ranges == nullptr) return {};
    for (const SensorInfo& sensor : simulation_.sensors()) {
      const Measurement measured = simulation_.measurement(sensor.name);
      const MeasuredArray* const ranges = measured.find("range_m");
      const auto* const numbers = ranges == nullptr ? nullptr : std::get_if<SharedArray<float>>(&ranges->numbers);
      if (numbers == nullptr || numbers->data() != beam.ranges) continue;
      return "&select=beam:" + detail::in_link(sensor.name) + ":" + std::to_string(beam.index);
    }
    return {};
  }

  std::vector<std::string> command(const std::filesystem::path& folder, const std::string& failure) const {
    const char* const program = std::getenv("SIMVIS_RUN");
    const SimulationDesc& desc = desc_.simulation;
    std::vector<std::string> all{program == nullptr ? "simvis-run" : program,
                                 "--quiet",
                                 "--frames",
                                 std::to_string(frames_.size()),
                                 "--rate",
                                 desc.frames_when_due ? "auto" : detail::exact(desc.rate_hz),
                                 "--seed",
                                 std::to_string(desc.seed),
                                 "--page",
                                 (folder / "failure.html").string(),
                                 "--record",
                                 (folder / "failure.mcap").string(),
                                 "--failure",
                                 failure,
                                 "--out",
                                 (folder / "run").string()};
    for (const std::string& plugin : loaded_plugins()) all.insert(all.end(), {"--plugin", plugin});
    if (!desc.device.select.empty()) all.insert(all.end(), {"--device", desc.device.select});
    if (std::ranges::find(changed_, true) != changed_.end()) {
      all.insert(all.end(), {"--trajectory", (folder / "values.csv").string()});
    }
    for (const PackageFolder& each : desc.packages) {
      all.insert(all.end(), {"--package", each.name + "=" + each.folder.string()});
    }
    all.push_back(scene_.string());
    return all;
  }

  /// Writes the page and the recording, which show the text of the verdict. Returns the lines of the message that name
  /// them.
  std::string write_evidence(const Verdict& failure) const {
    const char* const wanted = std::getenv("SIMVIS_EVIDENCE");
    const bool is_wanted = wanted != nullptr && *wanted != '\0';
    const std::filesystem::path root = !desc_.evidence.empty() ? desc_.evidence
                                       : is_wanted             ? wanted
                                                               : "simvis-evidence";
    if (root == "none" || frames_.empty()) return {};
    std::filesystem::path folder;
    try {
      folder = detail::make_new_folder(std::filesystem::absolute(root), desc_.name);
      write_values(folder / "values.csv");
    } catch (const std::exception& failed) {  // the verdict counts more than the evidence
      return std::string("\nno evidence: ") + failed.what();
    }
    const std::vector<std::string> again = command(folder, failure.text);
    if (const std::string fault = detail::fault_of_program(again); !fault.empty()) {
      return "\nno evidence: " + fault + "; SIMVIS_RUN names the program";
    }
    return "\npage:      file://" + (folder / "failure.html").string() +
           "#frame=" + std::to_string(frames_.size() - 1) + selection(failure.beam) +
           "\nrecording: " + (folder / "failure.mcap").string() + "\nagain:     " + again[0] + " --again " +
           (folder / "run/run.json").string() + " --out " + (folder / "again").string();
  }

  std::filesystem::path scene_;
  RunDesc desc_;
  Simulation simulation_;
  std::vector<std::pair<Check, std::string>> checks_;
  std::vector<double> before_;  // values after the last frame
  std::vector<bool> changed_;   // of the scene as it was loaded: by the test
  std::vector<FrameValues> frames_;
  Verdict result_{true, "nothing has failed"};
};

}  // namespace simvis::test_kit
