#include "import/sandbox/sandboxed_decode.h"

#include <utility>
#include <vector>

#include <simvis/error.h>
#include "import/sandbox/import_answer.h"
#include "import/sandbox/import_program.h"
#include "import/sandbox/imported_scene.h"
#include "import/sandbox/picture_values.h"
#include "import/sandbox/sandbox_process.h"

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
  const ImportAnswer answer = read_import_answer(report.answer.bytes());
  const HelperFault fault = fault_of(report.end, answer);
  if (fault.blame != Blame::nobody) {
    throw_fault(fault.blame, subject + (fault.is_reported ? " " : ": the program that decodes it ") + fault.reason);
  }
  if (!answer.scene) throw_fault(Blame::machine, subject + ": the program that decodes it returned nothing");
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

HeightPicture decode_heights_in_sandbox(std::span<const std::uint8_t> bytes, const std::string& subject,
                                        const DecodeLimits& limits) {
  return decode(bytes, {"heights"}, subject, limits, [&](std::span<const std::uint8_t> content) {
    HeightPicture picture;
    if (!unpack_heights(content, picture)) throw InputError(subject + " gives a picture that does not fit");
    return picture;
  });
}

SkyPicture decode_sky_in_sandbox(std::span<const std::uint8_t> bytes, const std::string& subject,
                                 const DecodeLimits& limits) {
  return decode(bytes, {"sky"}, subject, limits, [&](std::span<const std::uint8_t> content) {
    SkyPicture picture;
    if (!unpack_sky(content, picture)) throw InputError(subject + " gives a picture that does not fit");
    return picture;
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
