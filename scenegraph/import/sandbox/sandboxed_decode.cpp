#include "scenegraph/import/sandbox/sandboxed_decode.h"

#include <utility>
#include <vector>

#include <simvis/error.h>
#include "scenegraph/import/sandbox/import_answer.h"
#include "scenegraph/import/sandbox/import_program.h"
#include "scenegraph/import/sandbox/imported_scene.h"
#include "scenegraph/import/sandbox/sandbox_process.h"

namespace simvis {
namespace {

// Calls `use` with the content of the program's answer.
template <class Use>
auto decode(std::span<const std::uint8_t> bytes, std::vector<std::string> arguments, const std::string& subject,
            const DecodeLimits& limits, Use use) {
  SandboxCall call;
  call.program = import_program("simvis-decode");
  call.arguments = std::move(arguments);
  call.arguments.insert(call.arguments.begin(), std::to_string(limits.memory_bytes));
  call.input = bytes;
  call.time = limits.time;
  call.answer_bytes = limits.memory_bytes;
  const SandboxReport report = run_in_sandbox(call);
  const ImportAnswer answer = read_import_answer(report.answer);
  const auto fail = [&](const std::string& what) { throw InputError(subject + " " + what); };
  switch (report.end) {
    case SandboxEnd::finished:
      break;
    case SandboxEnd::crashed:
      fail("crashed the program that decodes it (" + report.reason + ")");
      break;
    case SandboxEnd::took_too_long:
      fail("was not decoded within " + std::to_string(limits.time.count()) + " ms");
      break;
    case SandboxEnd::answered_without_end:
      fail("gives more than " + std::to_string(limits.memory_bytes >> 20) + " MiB of content");
  }
  if (answer.refusal) fail(*answer.refusal);
  if (!answer.scene) fail("has no content");
  return use(*answer.scene);
}

}  // namespace

Texture decode_picture_in_sandbox(std::span<const std::uint8_t> bytes, const std::string& subject,
                                  const DecodeLimits& limits) {
  return decode(bytes, {"picture"}, subject, limits, [&](std::span<const std::uint8_t> content) {
    ImportedScene scene = unpack_imported_scene(content, subject + ": ");
    if (scene.textures.size() != 1) throw InputError(subject + " gives no picture");
    return std::move(scene.textures[0].texture);
  });
}

DracoMesh decode_draco_in_sandbox(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> attributes,
                                  const std::string& subject, const DecodeLimits& limits) {
  std::vector<std::string> arguments{"draco"};
  for (const DracoAttribute& attribute : attributes) arguments.push_back(to_argument(attribute));
  return decode(bytes, std::move(arguments), subject, limits, [&](std::span<const std::uint8_t> content) {
    DracoMesh mesh;
    if (!unpack_draco_mesh(content, attributes, mesh)) throw InputError(subject + " gives a mesh that does not fit");
    return mesh;
  });
}

}  // namespace simvis
