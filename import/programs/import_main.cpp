// The main() of the programs simvis-import-mesh and simvis-import-inventor, which SimVis starts to read a part file:
//   simvis-import-... MEMORY_BYTES FILE [--ignore-up-axis] FOLDER...
// It reads files in the folders alone.
// The answer is written to the file descriptor kAnswerDescriptor.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "engine/base/input_log.h"
#include "engine/base/read_fence.h"
#include "import/programs/part_reader.h"
#include "import/programs/reported_faults.h"
#include "import/sandbox/import_limits.h"
#include "import/sandbox/sandbox_process.h"

namespace {

using namespace simvis;

void answer_request(const ReadRequest& request, const Folders& folders, std::size_t memory_bytes) {
  AnswerWriter answer(kAnswerDescriptor);
  Folders opened = folders;
  opened.insert(opened.end(), kFoldersOfReader.begin(), kFoldersOfReader.end());
  report_faults(answer, "reading takes", kRaiseLimits,
                {.memory_bytes = memory_bytes, .folders = opened, .program = kProgramOfReader}, [&] {
                  const ReadFence fence(closed_scope(folders));  // canonical folders
                  const InputLog inputs;
                  ImportedScene scene = read_part(request, answer);
                  for (const std::filesystem::path& file : inputs.files()) answer.add(AnswerKind::input, file.native());
                  answer.begin(AnswerKind::scene, packed_size(scene));
                  pack_imported_scene(scene, [&](std::span<const std::uint8_t> bytes) { answer.write(bytes); });
                });
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 4 || ::fcntl(kAnswerDescriptor, F_GETFD) < 0) {
    std::fputs("This program reads part files for SimVis, which starts it; it does nothing by itself.\n", stderr);
    return 2;
  }
  const bool ignore_up_axis = std::string_view(arguments[3]) == "--ignore-up-axis";
  const Folders folders(arguments + (ignore_up_axis ? 4 : 3), arguments + count);
  answer_request({arguments[2], ignore_up_axis}, folders, std::strtoull(arguments[1], nullptr, 10));
  ::_exit(0);  // skips the libraries' cleanup, which is useless here and may crash
}
