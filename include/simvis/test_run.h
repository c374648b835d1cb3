// A scene under test in C++: it is stepped to a limit, and leaves a page and a recording where a check fails. Programs
// that use it link simvis::testing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <simvis/export.h>
#include <simvis/simulation.h>
#include <simvis/verdict.h>

namespace simvis::test_kit {

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
/// Evidence  at the first check that fails, a second simulation in this process repeats the run, with the values that
///           parameters had in each frame, so passing tests pay nothing for it. It writes failure.html, which any
///           browser opens, and failure.mcap, up to the frame that failed. The page selects the beam of the scan that
///           failed. All types that this process knows are on it, also those of the test's own program. The message
///           says if the repeated run measured something else, as it does where a type of the test depends on what was
///           before, and a scanner of method="auto". Types of the test that keep something outside of their objects
///           see a second object of each; evidence = "none" makes none. Not repeated are commands executed during the
///           run, steps of other lengths than 1 / rate, and sensors switched on or off. Values that the scene's
///           elements and the test both set are those of the test.
/// Errors    of Simulation. InputError: the name of the scene file is empty; `limit_s` is not above 0; `name` is "." or
///           "..".
/// Threads   as Simulation.
class SIMVIS_API Run {
 public:
  /// A property that holds in each frame.
  using Check = std::function<Verdict(const Simulation&)>;

  /// Loads the scene. Throws as Simulation::load(), and InputError as above.
  explicit Run(const std::filesystem::path& scene, RunDesc desc = {});

  /// The simulation, to set values and to read measurements. step() of the Run makes its frames.
  Simulation& sim() { return simulation_; }
  /// Checks a property after each frame from now on.
  void always(Check check, std::string name = {}) { checks_.emplace_back(std::move(check), std::move(name)); }

  /// Makes one frame, and false where the limit is reached or a property of always() has failed: result() says which.
  bool step();

  /// Keeps the first verdict that is false, and writes its evidence. Returns the verdict, then with the time and the
  /// files in its text.
  Verdict check(Verdict verdict);

  /// True as long as nothing has failed; then the first verdict that was false.
  const Verdict& result() const { return result_; }

 private:
  struct FrameValues {
    std::int64_t time_ns;
    std::vector<double> values;  // of all parameters, when the frame began
  };

  void keep_values(const FrameTime& next);
  std::string selection(const JudgedBeam& beam) const;
  std::string repeat(const std::filesystem::path& folder, const std::string& failure) const;
  std::string write_evidence(const Verdict& failure) const;

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
