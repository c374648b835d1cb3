// The messages of a view, protocol `simvis.live.v1`: docs/live-view.md lists them. All numbers are little-endian.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "program/live/view_snapshot.h"

namespace simvis::live {

inline constexpr std::string_view kViewProtocol = "simvis.live.v1";

/// How the simulation runs.
struct ViewTime {
  double speed = 0;  ///< simulated seconds for each second of the wall clock
  bool playing = true;
  bool recorded = false;  ///< a recording: it cannot be changed
  /// The simulation that this one follows; runs: there is none, or its frames come.
  enum class Host : std::uint8_t { runs, stands, ended } host = Host::runs;
};

// Text messages.
/// `glb` is where the page finds the scene as a GLB.
std::string scene_message(const ViewScene& scene, std::string_view glb);
std::string frame_message(const ViewFrame& frame, const ViewTime& time);
/// What differs from `before`, everything without it; empty: nothing.
std::string values_message(const ViewFrame* before, const ViewFrame& frame);
std::string materials_message(const ViewFrame* before, const ViewFrame& frame);
std::string lights_message(const ViewFrame* before, const ViewFrame& frame);
std::string hidden_message(const ViewFrame* before, const ViewFrame& frame);
std::string environment_message(const ViewFrame* before, const ViewFrame& frame);
/// The bodies of physics, without their places. An empty text if the scene has none.
std::string bodies_message(const ViewScene& scene);
std::string error_message(std::string_view about, std::string_view message);
std::string saved_message(std::string_view xml);

// Binary messages.
/// The transforms that differ from `before`, all of them without it or in another scene; empty: none.
std::string transforms_message(const ViewFrame* before, const ViewFrame& frame);
/// The positions and normals of all meshes that are deformed since the scene was made; empty: they are the same as
/// `before`, or without it, in another scene, there are none.
std::string shapes_message(const ViewFrame* before, const ViewFrame& frame);
/// Places of the bodies of physics, and their contacts. Empty if the frame has no physics.
std::string physics_message(const ViewFrame& frame);
std::string scan_message(const ViewScan& scan);
/// Colour as the bytes of a PNG file, the very bytes that simvis-run writes; other images as their numbers.
std::string image_message(const ViewImage& image);

struct ViewMessage {
  bool binary = false;
  std::string bytes;
};

/// All messages that bring a page from `before`, which is null for a page that has just opened, to `frame`. The scene
/// comes first, then what moves, then what was measured, and at the end op `frame`.
std::vector<ViewMessage> view_messages(const ViewFrame* before, const ViewFrame& frame, const ViewTime& time,
                                       std::string_view glb);

}  // namespace simvis::live
