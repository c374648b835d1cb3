// All consumers of a simulation's frames.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/command.h>
#include <simvis/parameters.h>
#include "simvis/scene_builder.h"
#include "simvis/sharing/frame_outlet.h"
#include "simvis/step_stages.h"

namespace simvis {

/// Each type of outlet is there at most once. Some of them also take inputs of other processes.
class FrameOutlets {
 public:
  bool empty() const { return outlets_.empty(); }
  void add(std::unique_ptr<FrameOutlet> outlet) { outlets_.push_back(std::move(outlet)); }

  /// The outlet of this type; null: there is none, or it has failed.
  template <typename Outlet>
  Outlet* find() const {
    for (const std::unique_ptr<FrameOutlet>& each : outlets_) {
      if (auto* const found = dynamic_cast<Outlet*>(each.get())) return found;
    }
    return nullptr;
  }
  /// As find(); the outlet belongs to the caller then.
  template <typename Outlet>
  std::unique_ptr<Outlet> remove() {
    Outlet* const found = find<Outlet>();
    if (found == nullptr) return nullptr;
    const auto place = std::ranges::find(outlets_, found, &std::unique_ptr<FrameOutlet>::get);
    static_cast<void>(place->release());
    outlets_.erase(place);
    return std::unique_ptr<Outlet>(found);
  }

  /// Before a frame: waits for clients in lock-step, then executes requests and sets values that others sent, in the
  /// scene that `execute` changes. `now_ns` is the time of the frame before. Throws MachineError if a client in
  /// lock-step is not ready in time.
  using Execute = std::function<void(std::span<const Command>)>;
  void take_inputs(BuiltScene& scene, const FrameTime& time, std::int64_t now_ns, StepStages& stages,
                   const Execute& execute);
  /// Shows clients the values that the elements of the frame under way have set.
  void follow_values(const Parameters& parameters);

  /// Throws InputError if an outlet cannot take frames of this scene.
  void check(const BuiltScene& scene) const {
    for (const std::unique_ptr<FrameOutlet>& each : outlets_) each->check(scene);
  }

  /// Offers a frame to each outlet; those that fail are closed. Throws OutletError that names all of them, after the
  /// last one.
  void offer(const Frame& frame, StepStages& stages);
  /// See FrameOutlet::end_early().
  void end_early();
  std::vector<std::string> take_warnings();

 private:
  std::vector<std::unique_ptr<FrameOutlet>> outlets_;  // in the order in which they were opened
};

}  // namespace simvis
