// The main() of the program simvis-decode, which SimVis starts to decode what its standard input holds:
//   simvis-decode MEMORY_BYTES picture
//   simvis-decode MEMORY_BYTES heights
//   simvis-decode MEMORY_BYTES sky
//   simvis-decode MEMORY_BYTES draco ID:COMPONENT_TYPE:COMPONENTS...
// The answer is written to the file descriptor kAnswerDescriptor.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/input_file.h"
#include "engine/base/read_error.h"
#include "import/programs/decode/any_picture.h"
#include "import/programs/decode/draco_reader.h"
#include "import/programs/decode/exr_file.h"
#include "import/programs/decode/sky_radiance.h"
#include "import/programs/reported_faults.h"
#include "import/sandbox/import_answer.h"
#include "import/sandbox/imported_scene.h"
#include "import/sandbox/picture_values.h"
#include "import/sandbox/sandbox_process.h"

namespace {

using namespace simvis;

std::vector<std::uint8_t> decode(std::span<char*> arguments) {
  // Standard input is a file in memory, or /dev/null for no bytes.
  constexpr const char* kStandardInput = "/proc/self/fd/0";
  const Bytes bytes = is_input_file(kStandardInput) ? read_whole_file(kStandardInput) : Bytes();
  if (std::string_view(arguments[0]) == "picture") {
    ImportedScene scene;
    scene.textures.push_back({.file = {}, .texture = decode_any_picture(bytes, "")});
    return pack_imported_scene(std::move(scene));
  }
  if (std::string_view(arguments[0]) == "heights") return pack_heights(decode_exr_heights(bytes));
  if (std::string_view(arguments[0]) == "sky") return pack_sky(decode_sky_radiance(bytes));
  std::vector<DracoAttribute> attributes;
  for (char* const argument : arguments.subspan(1)) {
    if (!parse_argument(argument, attributes.emplace_back())) throw std::runtime_error("malformed request");
  }
  return pack_draco_mesh(read_draco(bytes, attributes));
}

void answer_request(std::span<char*> arguments, std::size_t memory_bytes) {
  AnswerWriter answer(kAnswerDescriptor);
  report_faults(answer, "takes", "", {.memory_bytes = memory_bytes, .folders = {}, .program = HelperProgram::decode},
                [&] { answer.add(AnswerKind::scene, decode(arguments)); });
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3 || ::fcntl(kAnswerDescriptor, F_GETFD) < 0) {
    std::fputs("This program decodes pictures and meshes for SimVis, which starts it; it does nothing by itself.\n",
               stderr);
    return 2;
  }
  answer_request(std::span(arguments, static_cast<std::size_t>(count)).subspan(2),
                 std::strtoull(arguments[1], nullptr, 10));
  ::_exit(0);  // skips the libraries' cleanup, which is useless here and may crash
}
