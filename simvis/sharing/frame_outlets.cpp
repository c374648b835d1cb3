#include "simvis/sharing/frame_outlets.h"

#include <exception>
#include <utility>

#include <simvis/error.h>
#include "simvis/sharing/network.h"
#include "simvis/sharing/serving.h"

namespace simvis {

void FrameOutlets::take_inputs(BuiltScene& scene, const FrameTime& time, std::int64_t now_ns, StepStages& stages,
                               const Execute& execute) {
  Serving* const serving = find<Serving>();
  Network* const network = find<Network>();
  if (serving == nullptr && network == nullptr) return;
  stages.begin("clients");
  if (serving != nullptr) {
    serving->wait_for_clients(time);
    serving->take(scene, execute);
  }
  if (network != nullptr) network->take(scene, now_ns, execute);
}

void FrameOutlets::follow_values(const Parameters& parameters) {
  if (Serving* const serving = find<Serving>()) serving->follow_values(parameters);
}

void FrameOutlets::offer(const Frame& frame, StepStages& stages) {
  std::string failures;
  for (std::unique_ptr<FrameOutlet>& outlet : outlets_) {
    stages.begin(outlet->stage());
    try {
      outlet->frame(frame);
    } catch (const std::exception& error) {
      failures += (failures.empty() ? "" : "; ") + std::string(outlet->name()) + ": " + error.what();
      outlet.reset();
    }
  }
  stages.end();
  std::erase(outlets_, nullptr);
  if (!failures.empty()) throw OutletError(failures);
}

void FrameOutlets::end_early() {
  for (const std::unique_ptr<FrameOutlet>& outlet : outlets_) outlet->end_early();
}

std::vector<std::string> FrameOutlets::take_warnings() {
  std::vector<std::string> all;
  for (const std::unique_ptr<FrameOutlet>& outlet : outlets_) {
    for (std::string& warning : outlet->take_warnings()) all.push_back(std::move(warning));
  }
  return all;
}

}  // namespace simvis
