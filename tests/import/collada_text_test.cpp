// COLLADA files whose text other readers take although it breaks XML or the format, or that Assimp 5.2 misreads.
#include <doctest/doctest.h>

#include <string>

#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string utf16(const std::string& ascii, bool big_endian, bool marked) {
  std::string bytes;
  if (marked) bytes = big_endian ? "\xfe\xff" : "\xff\xfe";
  for (const char c : ascii) bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

std::string material_name(const Loaded& loaded) { return loaded.list.materials.at(0)->name; }

}  // namespace

TEST_CASE("COLLADA in UTF-16 and in declared Latin-1 is XML like any other") {
  TemporaryFolder folder;
  const std::string box = dae_box(kMetresZUp);
  for (const bool big_endian : {false, true}) {
    for (const bool marked : {false, true}) {
      CAPTURE(big_endian);
      CAPTURE(marked);
      write_bytes(folder / "box.dae", [&] {
        const std::string bytes = utf16(box, big_endian, marked);
        return ByteString(bytes.begin(), bytes.end());
      }());
      const Loaded loaded = load(folder / "box.dae");
      check_box(loaded.list);
      CHECK(loaded.warnings.empty());
    }
  }
  const std::string declared = with(box, "<?xml version=\"1.0\"?>", "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>");
  write_text(folder / "latin.dae", with(declared, "name=\"paint\"",
                                        "name=\"M\xf6"
                                        "bel\""));
  const Loaded latin = load(folder / "latin.dae");
  CHECK(latin.warnings.empty());
  CHECK(material_name(latin) ==
        "M\xc3\xb6"
        "bel");
}

TEST_CASE("COLLADA: bytes that are no UTF-8 are read as Windows-1252, with a warning that has the place") {
  TemporaryFolder folder;
  write_text(folder / "box.dae", with(dae_box(kMetresZUp), "name=\"paint\"",
                                      "\nname=\"M\xf6"
                                      "bel\x80\""));
  const Loaded loaded = load(folder / "box.dae");
  check_box(loaded.list);
  CHECK(material_name(loaded) ==
        "M\xc3\xb6"
        "bel\xe2\x82\xac");  // U+00F6, and U+20AC of byte 0x80
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "box.dae:2:8: byte 0xf6 and 1 more"));
}

TEST_CASE("COLLADA: what follows the root element is left out, with a warning") {
  TemporaryFolder folder;
  const std::string box = dae_box(kMetresZUp);
  const std::pair<const char*, std::string> rests[] = {
      {"zeros.dae", std::string(20, '\0')},
      {"older.dae", "\n" + std::string(20, '\0') + "1 2 3</p></polylist></COLLADA>"}};
  for (const auto& [name, rest] : rests) {
    CAPTURE(std::string(name));
    write_text(folder / name, box + rest);
    const Loaded loaded = load(folder / name);
    check_box(loaded.list);
    REQUIRE(loaded.warnings.size() == 1);
    CHECK(contains(loaded.warnings[0], "bytes behind </COLLADA> are left out"));
  }
  write_text(folder / "comment.dae", box + "\n<!-- the end -->\n");
  CHECK(load(folder / "comment.dae").warnings.empty());
}

TEST_CASE("COLLADA: white space around numbers is none of theirs") {
  TemporaryFolder folder;
  write_text(folder / "box.dae",
             dae_box(kMetresZUp, 1, "<matrix>\n 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 </matrix>",
                     "<emission><color> 0 0 0 1 </color></emission><diffuse><color>\n1 0.5 0 1</color></diffuse>"));
  const Loaded loaded = load(folder / "box.dae");
  check_box(loaded.list);
  CHECK(loaded.warnings.empty());
  CHECK(loaded.list.materials.at(0)->base_color.r == 1);
}

TEST_CASE("COLLADA: an image without a file leaves its materials white, with a warning") {
  TemporaryFolder folder;
  const std::string sampler =
      "<newparam sid=\"surface\"><surface type=\"2D\"><init_from>i</init_from></surface></newparam>"
      "<newparam sid=\"sampler\"><sampler2D><source>surface</source></sampler2D></newparam><technique sid=\"t\">";
  std::string text = dae_box(kMetresZUp, 1, "", "<diffuse><texture texture=\"sampler\" texcoord=\"UV\"/></diffuse>");
  text = with(text, "<technique sid=\"t\">", sampler);
  text = with(text, "<library_effects>", "<library_images>\n<image id=\"i\"/></library_images><library_effects>");
  write_text(folder / "box.dae", text);
  const Loaded loaded = load(folder / "box.dae");
  check_box(loaded.list);
  CHECK(loaded.list.materials.at(0)->base_color == glm::vec4(1));
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(contains(loaded.warnings[0], "box.dae:2:"));
  CHECK(contains(loaded.warnings[0], "image \"i\": names no file"));
  // Assimp 5.2 crashes on these.
  for (const char* empty :
       {"<image id=\"i\"><init_from/></image>", "<image id=\"i\"><init_from> </init_from></image>"}) {
    write_text(folder / "box.dae", with(text, "<image id=\"i\"/>", empty));
    const Loaded same = load(folder / "box.dae");
    check_box(same.list);
    CHECK(same.warnings == loaded.warnings);
  }
}

namespace {

// A triangle whose two sets of texture coordinates are (set + 1) / 4 in every corner, and a picture on the coordinates
// that `texture` names.
std::string textured(const std::string& texcoord, const std::string& binding, const std::string& sets) {
  std::string inputs;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    inputs += std::string("<input semantic=\"TEXCOORD\" source=\"#t") + static_cast<char>('0' + i) +
              "\" offset=\"0\" set=\"" + sets[i] + "\"/>";
  }
  const auto source = [](const std::string& id, const std::string& numbers, const std::string& count,
                         const std::string& parameters) {
    return "<source id=\"" + id + "\"><float_array id=\"" + id + "a\" count=\"" + count + "\">" + numbers +
           "</float_array><technique_common><accessor source=\"#" + id + "a\" count=\"3\" stride=\"" +
           std::to_string(parameters.size()) + "\">" +
           [&] {
             std::string all;
             for (const char name : parameters) all += std::string("<param name=\"") + name + "\" type=\"float\"/>";
             return all;
           }() +
           "</accessor></technique_common></source>";
  };
  return std::string("<COLLADA version=\"1.4.1\"><asset>") + kMetresZUp +
         "</asset><library_images><image id=\"i\"><init_from>dot.png</init_from></image></library_images>"
         "<library_effects><effect id=\"e\"><profile_COMMON><technique sid=\"t\"><lambert><diffuse>"
         "<texture texture=\"i\" texcoord=\"" +
         texcoord +
         "\"/></diffuse></lambert></technique></profile_COMMON></effect>"
         "</library_effects><library_materials><material id=\"m\" name=\"m\"><instance_effect url=\"#e\"/></material>"
         "</library_materials><library_geometries><geometry id=\"g\"><mesh>" +
         source("p", "0 0 0 1 0 0 0 1 0", "9", "XYZ") + source("t0", "0.25 0.25 0.25 0.25 0.25 0.25", "6", "ST") +
         source("t1", "0.5 0.5 0.5 0.5 0.5 0.5", "6", "ST") +
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"1\" "
         "material=\"s\">"
         "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>" +
         inputs +
         "<p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
         "<visual_scene id=\"vs\"><node id=\"n\"><instance_geometry url=\"#g\"><bind_material><technique_common>"
         "<instance_material symbol=\"s\" target=\"#m\">" +
         binding +
         "</instance_material></technique_common></bind_material></instance_geometry></node></visual_scene>"
         "</library_visual_scenes><scene><instance_visual_scene url=\"#vs\"/></scene></COLLADA>";
}

// The texture coordinate that the picture is drawn with.
float shown_u(const Loaded& loaded) {
  const Material& material = *loaded.list.materials.at(0);
  REQUIRE(material.base_color_texture != nullptr);
  return loaded.list.meshes.at(0)->attributes.at(0).uv[static_cast<std::size_t>(material.uv_set)].x;
}

}  // namespace

TEST_CASE("COLLADA: the set of texture coordinates is the one that is bound, else the one that the name's end says") {
  TemporaryFolder folder;
  write_bytes(folder / "dot.png", png(1, 1, 8, 6, {{255, 0, 0, 255}}));
  const auto bind = [](const std::string& name, const std::string& set) {
    return "<bind_vertex_input semantic=\"" + name + "\" input_semantic=\"TEXCOORD\" input_set=\"" + set + "\"/>";
  };
  struct Binding {
    std::string texcoord, binding, sets;
    float u;
    bool warns;
  };
  const Binding bindings[] = {
      {"UR20_base-mesh-map-0", bind("UR20_base-mesh-map-0", "0"), "0", 0.25f, false},
      {"UR20_base", "", "0", 0.25f, false},  // there is one set only, so nothing is guessed
      {"ID16", bind("ID16", "0"), "01", 0.25f, false},
      {"ID16", bind("ID16", "1"), "01", 0.5f, false},
      {"CHANNEL2", bind("CHANNEL2", "2"), "12", 0.5f, false},  // sets 1 and 2: Assimp stores them as 0 and 1
      {"CHANNEL1", bind("CHANNEL1", "1"), "12", 0.25f, false},
      {"late", bind("late", "7"), "7", 0.25f, false},
      {"swapped", bind("swapped", "0"), "10", 0.5f, false},  // the second input is set 0
      {"UVSET1", "", "01", 0.5f, true},
      {"UR20_base", "", "01", 0.25f, true},
  };
  for (const Binding& binding : bindings) {
    CAPTURE(binding.texcoord);
    CAPTURE(binding.sets);
    write_text(folder / "t.dae", textured(binding.texcoord, binding.binding, binding.sets));
    const Loaded loaded = load(folder / "t.dae");
    CHECK(shown_u(loaded) == binding.u);
    REQUIRE(loaded.warnings.size() == (binding.warns ? 1 : 0));
    if (binding.warns) CHECK(contains(loaded.warnings[0], "no <bind_vertex_input> binds them"));
  }
}

TEST_SUITE_END();
