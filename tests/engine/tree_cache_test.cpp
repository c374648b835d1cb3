#include "engine/geometry/tree_cache.h"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

#include <simvis/ray_caster.h>
#include "engine/base/cache_file.h"
#include "tests/support/random_room.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"
#include "tests/support/tree_check.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeaderBytes = 40, kWordsAt = 24, kChecksumAt = 32;

/// A file with these words that is correct otherwise.
std::string with_words(const std::string& good, const std::vector<std::uint32_t>& words) {
  std::string bytes = good.substr(0, kHeaderBytes);
  bytes.append(reinterpret_cast<const char*>(words.data()), words.size() * sizeof words[0]);
  const std::uint64_t count = words.size(), checksum = cache_checksum(std::string_view(bytes).substr(kHeaderBytes));
  std::memcpy(bytes.data() + kWordsAt, &count, sizeof count);
  std::memcpy(bytes.data() + kChecksumAt, &checksum, sizeof checksum);
  return bytes;
}

std::vector<std::uint32_t> file_words(const std::string& file) {
  std::vector<std::uint32_t> words((file.size() - kHeaderBytes) / sizeof(std::uint32_t));
  std::memcpy(words.data(), file.data() + kHeaderBytes, words.size() * sizeof words[0]);
  return words;
}

bool same(const WideBvh& a, const WideBvh& b) {
  return std::ranges::equal(a.nodes(), b.nodes(), [](const WideNode& x, const WideNode& y) {
    bool equal = x.children == y.children && x.parent == y.parent && x.place == y.place;
    for (std::uint32_t lane = 0; lane < x.children; ++lane) {
      equal &= x.child[lane] == y.child[lane] && x.primitives[lane] == y.primitives[lane] && x.box(lane) == y.box(lane);
    }
    return equal;
  });
}

/// A mesh just large enough for the cache, its tree as it is built, and as it is loaded with a folder.
struct Kept {
  Mesh mesh = sphere_mesh(3, 92);
  std::vector<Box> boxes;
  std::vector<WideBvh::Leaf> leaves;
  WideBvh made;
  TemporaryFolder folder;

  Kept() {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::vec3 &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                      &c = mesh.positions[mesh.indices[i + 2]];
      boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    }
    REQUIRE(boxes.size() >= kMinCachedTriangles);
    REQUIRE(boxes.size() < kMinCachedTriangles * 5 / 4);
    made = WideBvh(boxes, leaves);
  }
  std::string file() const {
    const std::vector<std::string> files = files_below(folder.path());
    REQUIRE(files.size() == 1);
    return files[0];
  }
  /// Checks that the tree is correct, and returns whether it equals the built one.
  bool had_as_made() const {
    std::vector<WideBvh::Leaf> found;
    const WideBvh tree = make_tree_cached(mesh, boxes, found, folder.path());
    check_tree(tree, boxes, found);
    return same(tree, made) && found == leaves;
  }
};

}  // namespace

TEST_CASE("a tree is kept, and a damaged file is replaced") {
  const Kept kept;
  CHECK(kept.had_as_made());
  const fs::path file = kept.folder / kept.file();
  const std::string good = read_text(file);
  // It is used, so it is not written again.
  const auto long_ago = fs::last_write_time(file) - std::chrono::hours(1);
  fs::last_write_time(file, long_ago);
  CHECK(kept.had_as_made());
  CHECK(fs::last_write_time(file) == long_ago);
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kHeaderBytes, good.size() - 1}) {
    write_text(file, good.substr(0, size));
    CHECK(kept.had_as_made());
    CHECK(read_text(kept.folder / kept.file()) == good);
  }
  for (const std::size_t byte :
       {std::size_t{0}, std::size_t{7}, std::size_t{9}, kWordsAt, kChecksumAt, kHeaderBytes, good.size() - 1}) {
    CAPTURE(byte);
    std::string bad = good;
    bad[byte] = static_cast<char>(bad[byte] ^ 0x10);
    write_text(file, bad);
    CHECK(kept.had_as_made());
    CHECK(read_text(kept.folder / kept.file()) == good);
  }
}

TEST_CASE("the tree is correct for any words in a file") {
  const Kept kept;
  CHECK(kept.had_as_made());
  const fs::path file = kept.folder / kept.file();
  const std::string good = read_text(file);
  const std::vector<std::uint32_t> words = file_words(good);
  std::mt19937 random(4);
  const auto below = [&](std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  };
  const int changes = sanitized() ? 30 : 150;
  for (int i = 0; i < changes; ++i) {
    std::vector<std::uint32_t> bad = words;
    const std::size_t at = below(2) ? below(words.size()) : below(40);
    const int change = static_cast<int>(below(4));
    if (change == 0) bad[at] ^= 1u << below(32);
    if (change == 1) bad[at] = bad[below(bad.size())];
    if (change == 2) bad.resize(at);
    if (change == 3) bad.insert(bad.begin() + static_cast<std::ptrdiff_t>(at), bad[below(bad.size())]);
    write_text(file, with_words(good, bad));
    kept.had_as_made();
  }
}

TEST_CASE("a consistent file with duplicate or missing content is refused") {
  const Kept kept;
  CHECK(kept.had_as_made());
  const fs::path file = kept.folder / kept.file();
  const std::string good = read_text(file);
  const std::vector<std::uint32_t> words = file_words(good);
  // The first node with space for another child, and its first leaf.
  std::size_t node = 2;
  while (words[node] == WideNode::kMax) node += 1 + words[node];
  std::size_t leaf = node + 1;
  while (words[leaf] >> 29 == 0) ++leaf;
  REQUIRE(leaf <= node + words[node]);
  const auto with_child = [&](std::uint32_t word) {
    std::vector<std::uint32_t> bad = words;
    ++bad[node];
    bad.insert(bad.begin() + static_cast<std::ptrdiff_t>(node) + 1, word);
    return bad;
  };
  std::vector<std::uint32_t> less = words;
  less[leaf] = (words[leaf] & ((1u << 29) - 1)) | 1u << 29;
  std::uint32_t* const primitives = &less[words.size() - 4 * words[1] + 4 * (less[leaf] & ((1u << 29) - 1))];
  std::fill(primitives + 1, primitives + 4, primitives[0]);
  REQUIRE((words[leaf] >> 29) > 1);
  for (const std::vector<std::uint32_t>& bad : {with_child(words[leaf]), with_child(0), less}) {
    write_text(file, with_words(good, bad));
    CHECK(kept.had_as_made());
  }
}

TEST_CASE("a correct tree that is too deep for traversal is refused") {
  const Kept kept;
  CHECK(kept.had_as_made());
  const fs::path file = kept.folder / kept.file();
  const std::string good = read_text(file);
  // A chain of this many nodes with one leaf each, followed by eight nodes per node.
  const auto words_of_chain = [&](std::uint32_t length) {
    std::vector<std::vector<std::uint32_t>> nodes;
    std::vector<std::uint32_t> leaves;
    const auto leaf = [&](std::uint32_t first, std::uint32_t primitives) {
      const auto number = static_cast<std::uint32_t>(leaves.size() / 4);
      for (std::uint32_t k = 0; k < 4; ++k) leaves.push_back(first + std::min(k, primitives - 1));
      return number | primitives << 29;
    };
    const std::function<std::uint32_t(std::uint32_t, std::uint32_t, std::uint32_t)> node =
        [&](std::uint32_t first, std::uint32_t count, std::uint32_t chain) {
          const auto index = static_cast<std::uint32_t>(nodes.size());
          nodes.emplace_back();
          std::vector<std::uint32_t> children;
          if (count <= 8 * 4) {
            for (std::uint32_t i = 0; i < count; i += 4) children.push_back(leaf(first + i, std::min(4u, count - i)));
          } else if (chain > 0) {
            children = {leaf(first, 4), node(first + 4, count - 4, chain - 1)};
          } else {
            for (std::uint32_t i = 0; i < 8; ++i) {
              const std::uint32_t begin = count * i / 8, end = count * (i + 1) / 8;
              children.push_back(node(first + begin, end - begin, 0));
            }
          }
          nodes[index] = children;
          return index;
        };
    node(0, static_cast<std::uint32_t>(kept.boxes.size()), length);
    std::vector<std::uint32_t> words{static_cast<std::uint32_t>(nodes.size()),
                                     static_cast<std::uint32_t>(leaves.size() / 4)};
    for (const std::vector<std::uint32_t>& children : nodes) {
      words.push_back(static_cast<std::uint32_t>(children.size()));
      words.insert(words.end(), children.begin(), children.end());
    }
    words.insert(words.end(), leaves.begin(), leaves.end());
    return words;
  };
  write_text(file, with_words(good, words_of_chain(Bvh::kMaxDepth - 8)));
  CHECK_FALSE(kept.had_as_made());
  write_text(file, with_words(good, words_of_chain(Bvh::kMaxDepth)));
  CHECK(kept.had_as_made());
}

TEST_CASE("meshes of the first frame of a scene are cached, later ones are not, and hits are the same") {
  const TemporaryFolder folder;
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 200; ++i)
    directions.push_back(glm::normalize(glm::dvec3(std::cos(0.1 * i), std::sin(0.1 * i), 0.1)));
  DrawList list;
  add_item(list, sphere_mesh(3, 92), glm::translate(glm::dmat4(1.0), {0.5, 0.2, 1}));
  const auto hits_by = [&](RayCaster& caster) {
    std::vector<RayHit> hits(directions.size());
    caster.set_world(list);
    caster.cast(glm::dmat4(1.0), directions, hits);
    return hits;
  };
  const std::vector<RayHit> expected = hits_by(*make_host_ray_caster());
  CHECK(files_below(folder.path()).empty());
  for (int run = 0; run < 2; ++run) {
    const std::unique_ptr<RayCaster> caster = make_host_ray_caster(folder.path());
    CHECK(hits_by(*caster) == expected);
    CHECK(files_below(folder.path()).size() == 1);
    DrawList more = list;
    add_item(more, sphere_mesh(2, 94), glm::dmat4(1.0));
    std::vector<RayHit> hits(directions.size());
    caster->set_world(more);
    caster->cast(glm::dmat4(1.0), directions, hits);
    CHECK(std::ranges::all_of(hits, [](const RayHit& hit) { return hit.item == 1; }));
    CHECK(files_below(folder.path()).size() == 1);
  }
}

TEST_SUITE_END();
