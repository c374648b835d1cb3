// OBJ, PLY, STL and COLLADA parts with mistakes, truncated or with flipped bits.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "import/programs/polygon.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string error(const std::filesystem::path& file) {
  return error_of([&] { load(file); });
}

}  // namespace

TEST_CASE("errors in mesh files are reported with their file") {
  TemporaryFolder folder;
  const auto error_in = [&](const char* name, const std::string& bytes) {
    write_text(folder / name, bytes);
    const std::string message = error(folder / name);
    CHECK(message.starts_with((folder / name).string()));
    CHECK(contains(message, "error: "));
    return message;
  };
  const std::string ply = ply_box(PlyFormat::text);
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  CHECK(contains(error_in("a.ply", with(ply, "vertex 8", "vertex 99999999999")), ".ply:4: error: element \"vertex\""));
  CHECK(contains(error_in("a2.ply", with(ply, "element face", "element 9face 0\nelement face")),
                 "element \"9face\" has no properties"));
  CHECK(contains(error_in("b.ply", with(ply, "4 0 3 2 1", "4 0 3 2 8")), "has the vertex 8, but there are 8"));
  CHECK(contains(error_in("c.ply", with(ply, "1 2 3\n", "1 nan 3\n")), "not a finite number"));
  CHECK(contains(error_in("d.ply", with(ply, "1 2 3\n", "1 3\n")), "too few values"));
  CHECK(contains(error_in("e.ply", with(ply, "element face", "element vertex")), "declared twice"));
  CHECK(contains(error_in("f.ply", ""), "ends too early"));
  std::string little = ply_box(PlyFormat::little);
  little.pop_back();
  CHECK(contains(error_in("g.ply", little), "ends too early"));
  std::string not_finite = ply_box(PlyFormat::big);
  not_finite.replace(not_finite.find("end_header\n") + 11, 4, std::string("\x7f\xc0\0\0", 4));
  CHECK(contains(error_in("h.ply", not_finite), "is not finite"));

  std::string stl = stl_box(true);
  stl.pop_back();
  CHECK(contains(error_in("a.stl", stl), "claims 12 facets"));
  std::string text_stl = stl_box(false);
  text_stl.resize(text_stl.size() / 2);
  CHECK(contains(error_in("b.stl", text_stl), "does not end with \"endsolid\""));
  error_in("c.stl", "");

  CHECK(contains(error_in("a.obj", with(obj_box(), "f 1 4 3 2", "f 1 4 3 9")), "out of range"));
  error_in("b.obj", "");
  error_in("c.obj", "# nothing is in here\n");
  write_text(folder / "e.mtl", "Kd 1 0 0\nnewmtl m\n");
  CHECK(contains(error_in("e.obj", "mtllib e.mtl\n" + obj_box()), "begins with \"Kd\", expected \"newmtl\""));
  write_text(folder / "e.txt", "Kd 1 0 0\n");
  error_in("g.obj", "mtllib e.txt\n" + obj_box());
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (std::size_t i = 0; i <= kMaxPolygonCorners; ++i) many += " " + std::to_string(1 + i % 3);
  CHECK(contains(error_in("f.obj", many + "\n"), "has 1001 corners, expected at most 1000"));
  CHECK(contains(error_in("d.obj", "mtllib d.mtl\nv nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite"));

  CHECK(contains(error_in("a.dae", "<COLLADA>\n<asset>"), "malformed XML"));
  std::string deep = "<COLLADA>";
  for (int i = 0; i < 300; ++i) deep += "<node>";
  for (int i = 0; i < 300; ++i) deep += "</node>";
  CHECK(contains(error_in("b.dae", deep + "</COLLADA>"), "nested deeper"));
  const std::string dae = dae_box(kMetresZUp);
  CHECK(contains(error_in("c.dae", with(dae, "#pa", "#none")), "accessor of \"#none\""));
  CHECK(contains(error_in("d.dae", with(dae, "count=\"8\"", "count=\"9\"")), "beyond its array of 24 values"));
  CHECK(contains(error_in("e.dae", with(dae, "\"VERTEX\"", "\"VORTEX\"")), "0 inputs of the semantic VERTEX"));
  CHECK(contains(error_in("f.dae", with(dae, "offset=\"0\"", "offset=\"-1\"")), "whole number from 0 to 63"));
  CHECK(contains(error_in("g.dae", with(dae, "<p>0 3", "<p>0 .")), "p holds \".\", expected whole numbers"));
}

TEST_CASE("missing material files are a warning") {
  TemporaryFolder folder;
  write_text(folder / "a.obj", "mtllib none.mtl\n" + obj_box());
  const Loaded loaded = load(folder / "a.obj");
  check_box(loaded.list);
  REQUIRE_FALSE(loaded.warnings.empty());
  CHECK(contains(loaded.warnings[0], "none.mtl"));
}

TEST_CASE("truncated files and files with flipped bits are loaded or refused, and loaded content is sound") {
  const int files = sanitized() ? 40 : 100;  // each is read by a process of its own
  TemporaryFolder folder;
  write_bytes(folder / "dots.png", png(2, 1, 8, 6, {{255, 0, 0, 255, 0, 255, 0, 0}}));
  const std::string mtl = "newmtl m\nKd 1 0.5 0\nKe 0 0 0\nd 0.25\nmap_Kd dots.png\n";
  const std::pair<const char*, std::string> seeds[] = {
      {"s.obj", "mtllib s.mtl\nusemtl m\n" + obj_box()},
      {"rich.obj",
       "# all that OBJ has\nmtllib s.mtl\no a\nv 0 0 0 1 0.5 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nvt 0 1\nvt 1 0 0\n"
       "vn 0 0 1\ng b c\ns 1\nusemtl m\nf 1/1/1 2/2/1 3/1/1\nf -1//-1 -2//-1 -3//-1\ns off\nl 1 2 3\np 1 2\n"
       "f 1/1 2/2 \\\n 3/1 1/1\n"},
      {"text.ply", ply_box(PlyFormat::text)},
      {"little.ply", ply_box(PlyFormat::little)},
      {"text.stl", stl_box(false)},
      {"binary.stl", stl_box(true)},
      {"s.dae", dae_box(kMetresZUp)},
      {"s.mtl", mtl}};
  Random random;
  for (const auto& seed : seeds) {
    const auto& name = seed.first;
    const auto& bytes = seed.second;
    int loaded = 0, crashed = 0;
    for (int i = 0; i < files; ++i) {
      CAPTURE(std::string(name));
      CAPTURE(i);
      std::string broken = bytes;
      if (random.below(4) == 0) {
        broken.resize(random.below(broken.size()));
      } else {
        // Half of them flip any bit, half change one digit to another, which keeps the file's form.
        const bool digits_only = random.below(2) == 0;
        for (std::uint64_t flips = 1 + random.below(8); flips > 0; --flips) {
          char& byte = broken[random.below(broken.size())];
          if (!digits_only) byte = static_cast<char>(byte ^ (1 << random.below(8)));
          if (digits_only && byte >= '0' && byte <= '9') byte = "0123456789-.e"[random.below(13)];
        }
      }
      const bool is_mtl = std::string_view(name) == "s.mtl";
      write_text(folder / "s.mtl", is_mtl ? broken : mtl);
      const std::filesystem::path file = folder / (is_mtl ? "s.obj" : name);
      std::filesystem::remove(file);
      write_text(file, is_mtl ? seeds[0].second : broken);
      try {
        for (const auto& mesh : load(file).list.meshes) {
          REQUIRE(mesh->attributes.size() == mesh->positions.size());
          for (const std::uint32_t index : mesh->indices) REQUIRE(index < mesh->positions.size());
          for (const glm::vec3& p : mesh->positions) REQUIRE(std::isfinite(p.x + p.y + p.z));
        }
        ++loaded;
      } catch (const InputError& refused) {
        REQUIRE(std::string(refused.what()).starts_with(folder.path().string()));
        crashed += std::string(refused.what()).find(" crashed (") != std::string::npos;
      }
    }
    MESSAGE(std::string(name) << ": " << loaded << " of " << files << " loaded");
    CHECK(loaded < files);
    CHECK(crashed == 0);  // what Assimp would fall over is refused with a reason
  }
}

TEST_SUITE_END();
