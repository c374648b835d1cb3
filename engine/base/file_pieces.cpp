#include "engine/base/file_pieces.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/base/input_file.h"

namespace simvis {

void read_in_pieces(const std::filesystem::path& file, const std::function<void(std::span<const std::uint8_t>)>& use) {
  constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
  const InputFile input(file);
  std::vector<std::uint8_t> piece(std::min(kPieceBytes, input.size()));
  for (std::size_t done = 0; done < input.size();) {
    const std::size_t got = input.read_into(std::span(piece).first(std::min(piece.size(), input.size() - done)), done);
    if (got == 0) return;
    use(std::span(piece).first(got));
    done += got;
  }
}

}  // namespace simvis
