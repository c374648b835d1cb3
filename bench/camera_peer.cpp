// Measures the overhead of SimVis over the device's work, and the work that its culling saves: a camera of 640 x 480
// with colour and depth, in scenes/marvin and in a lab of a million triangles with a moving robot, compared with two
// bare Vulkan loops.
//
//   camera_peer [FRAMES]
//
// A bare loop has no scene, plan or list: it submits a command buffer that was recorded before, waits for it, and
// copies as many bytes as are read back into its own memory.
//
// bare        The commands that SimVis recorded for the previous frame, unchanged: the same triangles after the same
//             culling, draws, shaders, targets, copies. This is the lower limit for any program that gives this device
//             this work.
// everything  The same picture with every triangle of the scene drawn, as a loop without culling does.
//
// This program defines functions with the names of the Vulkan loader's functions. They keep the last submission and
// call the loader. Prints CSV: for each scene the medians of frames in turns, and the ratio to the bare loop.
#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include <simvis/device.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "bench/timing.h"
#include "engine/render/renderer.h"

namespace {

/// The last submission of the process, and its device.
struct Submitted {
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::vector<VkCommandBuffer> commands;
} submitted;

template <typename Function>
Function* of_loader(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  if (found == nullptr) throw std::runtime_error(std::string("the Vulkan loader has no ") + name);
  return reinterpret_cast<Function*>(found);
}

}  // namespace

extern "C" {

/// Allows a recorded command buffer to be submitted again.
VKAPI_ATTR VkResult VKAPI_CALL vkBeginCommandBuffer(VkCommandBuffer commands, const VkCommandBufferBeginInfo* info) {
  static const auto pass_on = of_loader<decltype(vkBeginCommandBuffer)>("vkBeginCommandBuffer");
  VkCommandBufferBeginInfo again = *info;
  again.flags &= ~static_cast<VkCommandBufferUsageFlags>(VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT);
  return pass_on(commands, &again);
}

VKAPI_ATTR VkResult VKAPI_CALL vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo* infos, VkFence fence) {
  static const auto pass_on = of_loader<decltype(vkQueueSubmit)>("vkQueueSubmit");
  submitted.queue = queue;
  submitted.commands.clear();
  for (uint32_t i = 0; i < count; ++i) {
    const VkCommandBuffer* const first = infos[i].pCommandBuffers;
    submitted.commands.insert(submitted.commands.end(), first, first + infos[i].commandBufferCount);
  }
  return pass_on(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL vkCreateFence(VkDevice device, const VkFenceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator, VkFence* fence) {
  static const auto pass_on = of_loader<decltype(vkCreateFence)>("vkCreateFence");
  submitted.device = device;
  return pass_on(device, info, allocator, fence);
}

}  // extern "C"

namespace {

using namespace simvis;
using bench::Took;

/// Repeats the submission that is the last one when this object is created, on its device.
class BareLoop {
 public:
  BareLoop() : device_(submitted.device) {
    const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .pNext = nullptr, .flags = 0};
    check(vkCreateFence(device_, &info, nullptr, &fence_));
  }
  ~BareLoop() { vkDestroyFence(device_, fence_, nullptr); }
  BareLoop(const BareLoop&) = delete;
  BareLoop& operator=(const BareLoop&) = delete;

  void frame(const Submitted& work, std::size_t bytes_read_back) {
    if (bytes_read_back > from_.size()) {
      from_.resize(bytes_read_back);
      to_.resize(bytes_read_back);
    }
    const std::vector<VkCommandBuffer> commands = work.commands;
    VkSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = static_cast<uint32_t>(commands.size());
    info.pCommandBuffers = commands.data();
    check(vkQueueSubmit(work.queue, 1, &info, fence_));
    check(vkWaitForFences(device_, 1, &fence_, VK_TRUE, UINT64_MAX));
    check(vkResetFences(device_, 1, &fence_));
    std::memcpy(to_.data(), from_.data(), bytes_read_back);
  }

 private:
  static void check(VkResult result) {
    if (result != VK_SUCCESS) throw std::runtime_error("Vulkan result " + std::to_string(result));
  }

  VkDevice device_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  std::vector<char> from_, to_;
};

/// Draws without culling, on a device of its own.
class Everything {
 public:
  explicit Everything(const Simulation& simulation) {
    FramePlan plan = simulation.diagnostics().frame_plan();
    for (Pass& pass : plan.passes) {
      for (View& view : pass.views) view.culled = false;
    }
    renderer_.render(simulation.diagnostics().draw_list(), plan);
    renderer_.render(simulation.diagnostics().draw_list(), plan);  // uploads from buffers that are released afterwards
    work_ = submitted;
    loop_.emplace();
  }
  void frame() { loop_->frame(work_, counters().bytes_read_back); }
  const FrameCounters& counters() const { return renderer_.counters(); }

 private:
  Device device_;
  Renderer renderer_{device_};
  Submitted work_;
  std::optional<BareLoop> loop_;
};

void print(const char* scene, const char* loop, const std::vector<Took>& took, const std::vector<Took>& bare,
           const FrameCounters& counters) {
  const Took median = bench::median(took);
  std::printf("%s,%s,%.4f,%.4f,%.3f,%llu,%llu,%llu\n", scene, loop, median.wall_ms, median.caller_ms,
              median.wall_ms / bench::median(bare).wall_ms, static_cast<unsigned long long>(counters.draws),
              static_cast<unsigned long long>(counters.triangles),
              static_cast<unsigned long long>(counters.bytes_read_back));
  std::fflush(stdout);
}

/// `drive(frame)` moves the robot. The only camera of the scene that is on measures.
void compare(const char* scene, Simulation& simulation, int frames, const std::function<void(int)>& drive) {
  constexpr int kWarmUp = 10;
  simulation.step();
  BareLoop bare;
  Everything everything(simulation);
  std::vector<Took> simvis_took, bare_took, everything_took;
  for (int frame = 0; frame < kWarmUp + frames; ++frame) {
    drive(frame);
    const Took whole = bench::time_work([&] { simulation.step(); });
    const Submitted of_frame = submitted;
    const Took alone =
        bench::time_work([&] { bare.frame(of_frame, simulation.diagnostics().counters().bytes_read_back); });
    const Took all = bench::time_work([&] { everything.frame(); });
    if (frame < kWarmUp) continue;
    simvis_took.push_back(whole);
    bare_took.push_back(alone);
    everything_took.push_back(all);
  }
  print(scene, "simvis", simvis_took, bare_took, simulation.diagnostics().counters());
  print(scene, "bare", bare_took, bare_took, simulation.diagnostics().counters());
  print(scene, "everything", everything_took, bare_took, everything.counters());
}

void compare_in_marvin(int frames) {
  const std::filesystem::path folder = SIMVIS_SOURCE_DIR "/scenes/marvin";
  Simulation simulation = Simulation::load(folder / "marvin.xml");
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == "ROBOT_CAM");
  const Trajectory trajectory(folder / "drive.csv", simulation.parameters());
  compare("marvin", simulation, frames, [&](int) {
    trajectory.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
  });
}

void compare_in_lab(int frames) {
  const bench::SceneFolder folder;
  const char* const camera =
      "<sensor type=\"camera\" name=\"CAMERA\" insert_at=\"ROBOT\" width=\"640\" height=\"480\" "
      "outputs=\"color depth\" pose_offset=\"0 0 1.5 0 0 0\"/>";
  Simulation simulation = Simulation::load(bench::write_lab(folder.path(), 1'000'000, camera));
  compare("lab 1M", simulation, frames, [&](int frame) { bench::drive_lab(simulation, frame); });
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(1, std::atoi(argv[1])) : 200;
  std::printf("scene,loop,median_ms,caller_cpu_ms,ratio_to_bare,draws,triangles,bytes_read_back\n");
  compare_in_marvin(frames);
  compare_in_lab(frames);
  return 0;
}
