// What only a discrete GPU does, shown by a driver of the CPU behind the layer that changes its memory types
// (tests/fault_layer): its memory cannot be written by the host, so that every upload is a copy. The synchronization
// validation then says where a command reads what an earlier one may still write.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "tests/support/faulty_devices.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

const std::filesystem::path kValidation = "/usr/share/vulkan/explicit_layer.d";

TEST_CASE("no command reads what an earlier one may still write") {
  if (!std::filesystem::exists(kValidation / "VkLayer_khronos_validation.json")) {
    return test::skip("the validation layers are not installed");
  }
  // The pictures of the first frames lack several levels of the round shapes, so that the meshes move twice in a frame.
  std::string commands;
  for (int i = 0; i < 20; ++i) {
    commands += "<part name=\"BALL_" + std::to_string(i) + "\" insert_at=\"ROOT\" shape=\"sphere\" radius=\"" +
                std::to_string(0.2 + 0.05 * i) + "\" pose_offset=\"" + std::to_string(3 + 2 * i) + " " +
                std::to_string(0.3 * i - 3) + " 0 0 0 0\"/>\n";
  }
  const TemporaryFolder folder;
  const std::filesystem::path scene = folder / "scene.xml";
  write_text(scene, "<s>" + commands + std::string(kWallSensors) + "</s>");
  const auto run_with = [&](const std::string& memory_types) {
    return run_simvis({scene.string(), "--frames", "3", "--out", (folder / "out").string()},
                      {"VK_ADD_LAYER_PATH=" + kFaultLayers + ":" + kValidation.string(),
                       "VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation:" + std::string(kFaultLayer),
                       "VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT",
                       "SIMVIS_FAULT_HEAPS=512M,512M", "SIMVIS_FAULT_MEMORY_TYPES=" + memory_types});
  };
  // The layers are there: no type can be mapped.
  CHECK(run_with("L@0").err.find("no memory type of ") != std::string::npos);
  const ProcessResult run = run_with("L@0,VC@1,VCK@1");
  CAPTURE(run.out);
  CAPTURE(run.err);
  CHECK(run.exit_code == 0);
  for (const char* const word : {"HAZARD", "VUID"}) {
    CHECK(run.out.find(word) == std::string::npos);
    CHECK(run.err.find(word) == std::string::npos);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
