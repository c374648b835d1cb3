// One rule for what part files of all formats name, however they write it: the file lies in a folder of the part.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "engine/base/input_log.h"
#include "engine/base/read_fence.h"
#include "simvis/scene_builder.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/parts/inventor_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

namespace {

namespace fs = std::filesystem;

ByteString grey_png() { return png(2, 2, 8, 0, {{10, 200}, {200, 10}}); }

std::string replaced(std::string text, const std::string& name) {
  for (std::size_t at = 0; (at = text.find('@', at)) != text.npos; at += name.size()) text.replace(at, 1, name);
  return text;
}

std::string dae_with_picture() {
  std::string dae = dae_box(kMetresZUp, 1, "", "<diffuse><texture texture=\"i\" texcoord=\"UV\"/></diffuse>");
  return dae.insert(dae.find("<library_effects>"),
                    "<library_images><image id=\"i\"><init_from>@</init_from></image></library_images>");
}

std::string gltf_with(const std::string& what) {
  GltfBuilder builder;
  builder.triangle()["material"] = 0;
  if (what == "buffer") builder.root["buffers"].push_back({{"uri", "@"}, {"byteLength", 4}});
  builder.append("images", {{"uri", what == "image" ? "@" : "data:image/png;base64," + base64(grey_png())}});
  builder.append("textures", {{"source", 0}});
  builder.append("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return builder.text();
}

std::string urdf_with(const std::string& visual) {
  return "<?xml version='1.0'?>\n<robot name='r'><link name='l'><visual>" + visual + "</visual></link></robot>\n";
}

std::string sdf_with(const std::string& geometry) {
  return "<?xml version='1.0'?>\n<sdf version='1.9'><world name='w'><model name='m'><link name='l'><visual name='v'>"
         "<geometry>" +
         geometry + "</geometry></visual></link></model></world></sdf>\n";
}

const std::string kNamingBox = "mtllib part.mtl\nusemtl m\n" + obj_box();

// A part whose file, or a file of whose, names another file by @.
struct NamingPart {
  const char* format;
  std::string file, text, beside, beside_text, named;  // `named`: the ending of the other file
  bool needs_coin = false;
};

std::vector<NamingPart> naming_parts() {
  return {
      {"OBJ: material file", "part.obj", "mtllib @\nusemtl m\n" + obj_box(), "", "", "mtl"},
      {"MTL: picture", "part.obj", kNamingBox, "part.mtl", "newmtl m\nmap_Kd @\n", "png"},
      {"COLLADA: picture", "part.dae", dae_with_picture(), "", "", "png"},
      {"glTF: picture", "part.gltf", gltf_with("image"), "", "", "png"},
      {"glTF: buffer", "part.gltf", gltf_with("buffer"), "", "", "bin"},
      {"Inventor: picture", "part.iv", kInventorHeader + "Separator { Texture2 { filename \"@\" } Cube { } }", "", "",
       "png", true},
      {"Inventor: file", "part.iv", kInventorHeader + "Separator { Cube { } File { name \"@\" } }", "", "", "iv", true},
      {"VRML: picture", "part.wrl",
       kVrml97Header + "Shape { appearance Appearance { texture ImageTexture { url \"@\" } } geometry Box { } }", "",
       "", "png", true},
      {"URDF: mesh", "part.urdf", urdf_with("<geometry><mesh filename='@'/></geometry>"), "", "", "stl"},
      {"URDF: picture", "part.urdf",
       urdf_with("<geometry><box size='1 1 1'/></geometry><material name='m'><texture filename='@'/></material>"), "",
       "", "png"},
      {"SDF: mesh", "part.sdf", sdf_with("<mesh><uri>@</uri></mesh>"), "", "", "stl"},
      {"SDF: heights", "part.sdf", sdf_with("<heightmap><uri>@</uri><size>4 4 1</size></heightmap>"), "", "", "png"},
      {"MJCF: mesh", "part.xml",
       "<mujoco><asset><mesh name='m' file='@'/></asset><worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>",
       "", "", "stl"},
      {"MJCF: picture", "part.xml",
       "<mujoco><asset><texture name='t' type='2d' file='@'/><material name='m' texture='t'/></asset><worldbody>"
       "<geom type='box' size='1 1 1' material='m'/></worldbody></mujoco>",
       "", "", "png"},
      {"MJCF: include", "part.xml", "<mujoco><include file='@'/><worldbody><geom size='1'/></worldbody></mujoco>", "",
       "", "xml"},
      {"MJCF: attached model", "part.xml",
       "<mujoco><asset><model name='a' file='@'/></asset><worldbody><geom size='1'/><attach model='a' prefix='p'/>"
       "</worldbody></mujoco>",
       "", "", "xml"},
      {"ROS map: picture", "part.yaml",
       "image: @\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n", "", "",
       "png"},
      {"commands in a part", "part.iv",
       kInventorHeader + "Separator { Cube { } Info { string \"<part file='@' name='P'/>\" } }", "", "", "stl", true},
  };
}

void write_named(const fs::path& file) {
  const std::string ending = file.extension().string();
  fs::create_directories(file.parent_path());
  if (ending == ".png") write_bytes(file, grey_png());
  if (ending == ".stl") write_text(file, stl_box(true));
  if (ending == ".mtl") write_text(file, "newmtl m\nKd 1 0 0\n");
  if (ending == ".iv") write_text(file, kInventorHeader + "Separator { Sphere { } }\n");
  if (ending == ".bin") write_text(file, "1234");
  if (ending == ".xml") write_text(file, "<mujoco></mujoco>");
}

// Whether the file is opened when the part is loaded and a camera looks at it.
bool reads(const fs::path& model, const NamingPart& part, const std::string& name, const fs::path& file) {
  write_text(model / part.file, replaced(part.text, name));
  if (!part.beside.empty()) write_text(model / part.beside, replaced(part.beside_text, name));
  const InputLog inputs;
  try {
    BuiltScene built =
        build_scene(parse_commands("<part file='" + part.file + "' name='PART' insert_at='ROOT'/>", "s.xml", model));
    built.scene.read_pictures();
  } catch (const InputError&) {  // what a format makes of it is not tested here
  }
  for (const fs::path& opened : inputs.files()) {
    if (fs::exists(opened) && fs::equivalent(opened, file)) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("what a part names is read in the folders of the part and not outside, in every format and spelling") {
  int tried = 0;
  for (const NamingPart& part : naming_parts()) {
    if (part.needs_coin && !has_coin()) continue;
    CAPTURE(std::string(part.format));
    const TemporaryFolder folder;
    const fs::path model = folder / "models/car/meshes";
    const std::string name = "named." + part.named;
    const fs::path secret = folder / name, beside = folder / ("models/car/files/" + name), own = model / name;
    for (const fs::path& file : {secret, beside, own}) write_named(file);
    write_named(folder / ("models/" + name));
    CHECK(reads(model, part, name, own));
    CHECK(reads(model, part, "../files/" + name, beside));
    fs::remove(own);  // pictures that are not where the part says are looked for there
    fs::create_symlink(secret, model / ("link." + part.named));
    for (const std::string& written :
         {"../../../" + name, secret.string(), "file://" + secret.string(), "%2e%2e/%2E%2e/../" + name,
          "..\\..\\..\\" + name, "x/../../../../" + name, "link." + part.named}) {
      CAPTURE(written);
      CHECK_FALSE(reads(model, part, written, secret));
      ++tried;
    }
    // With its mark, all of the model is open.
    write_text(folder / "models/model.config", "");
    CHECK(reads(model, part, "../../" + name, folder / ("models/" + name)));
    CHECK_FALSE(reads(model, part, "../../../" + name, secret));
  }
  CHECK(tried > 50);
}

// What is said of a part in a request that may read files of its folder alone.
std::string said_to_request(const fs::path& model, const NamingPart& part, const std::string& name) {
  const ReadFence fence(closed_scope({model}));
  write_text(model / part.file, replaced(part.text, name));
  if (!part.beside.empty()) write_text(model / part.beside, replaced(part.beside_text, name));
  std::string said;
  try {
    BuiltScene built =
        build_scene(parse_commands("<part file='" + part.file + "' name='PART' insert_at='ROOT'/>", "s.xml", model));
    built.scene.read_pictures();
    for (const std::string& warning : built.scene.warnings()) said += warning + "\n";
  } catch (const InputError& error) {
    said += error.what();
  }
  return said;
}

TEST_CASE("a part of a request names no file outside of the folders of the request, and is not told what is there") {
  int tried = 0;
  for (const NamingPart& part : naming_parts()) {
    if (part.needs_coin && !has_coin()) continue;
    CAPTURE(std::string(part.format));
    const TemporaryFolder folder;
    const fs::path model = folder / "models/car/meshes";
    const std::string name = "named." + part.named, other = "other." + part.named;
    const fs::path beside = folder / ("models/car/files/" + name), own = model / name;
    for (const fs::path& file : {beside, own}) write_named(file);
    write_text(folder / "models/car/files/package.xml", "<package><name>files</name></package>");
    fs::create_symlink(beside, model / ("link." + part.named));
    const ReadFence fence(closed_scope({model}));
    CHECK(reads(model, part, name, own));
    for (const std::string& written :
         {"../files/" + name, beside.string(), "package://files/" + name, "link." + part.named}) {
      CAPTURE(written);
      CHECK_FALSE(reads(model, part, written, beside));
      ++tried;
    }
    fs::remove(own);  // which would take the place of a picture that is not found
    if (std::string(part.format) == "Inventor: file") continue;  // Coin's words say whether a file is there
    for (const std::string start : {"../files/", "package://files/"}) {
      const std::string there = said_to_request(model, part, start + name);
      std::string gone = said_to_request(model, part, start + other);
      for (std::size_t at = 0; (at = gone.find("other.", at)) != gone.npos;) gone.replace(at, 5, "named");
      CHECK(there == gone);
    }
  }
  CHECK(tried > 40);
}

TEST_CASE("the name of a package is no way out of the folders of a part") {
  const TemporaryFolder folder;
  const fs::path model = folder / "a/b/c/d/e/f/p", secret = folder / "secret.stl";  // too far to count as near
  fs::create_directories(model);
  write_named(secret);
  for (const NamingPart& part : naming_parts()) {
    const bool is_tried = std::string(part.format) == "URDF: mesh" || std::string(part.format) == "SDF: mesh";
    if (!is_tried) continue;
    for (const char* const written : {"package://../secret.stl", "package://./secret.stl", "package:///secret.stl",
                                      "model://../secret.stl", "model://./secret.stl"}) {
      CAPTURE(written);
      CHECK_FALSE(reads(model, part, written, secret));
    }
  }
}

TEST_CASE("percent-encoded names of VRML and COLLADA are found") {
  const TemporaryFolder folder;
  write_named(folder / "my picture.png");
  for (const NamingPart& part : naming_parts()) {
    const bool is_tried = std::string(part.format) == "VRML: picture" || std::string(part.format) == "COLLADA: picture";
    if (!is_tried || (part.needs_coin && !has_coin())) continue;
    CAPTURE(std::string(part.format));
    CHECK(reads(folder.path(), part, "my%20picture.png", folder / "my picture.png"));
    CHECK_FALSE(reads(folder.path(), part, "my%2picture.png", folder / "my picture.png"));
  }
}

TEST_CASE("folders of packages that the user gives, and of the scene, are open to parts") {
  const TemporaryFolder folder;
  const fs::path model = folder / "a/b/c", file = folder / "other/named.stl";
  fs::create_directories(model);
  write_named(file);
  write_text(model / "part.urdf", urdf_with("<geometry><mesh filename='../../../other/named.stl'/></geometry>"));
  const auto reads_it = [&](const fs::path& scene, std::vector<PackageFolder> packages) {
    const InputLog inputs;
    BuiltScene built;
    built.scene.set_packages(std::move(packages));
    try {
      SceneBuilder(built, {}).execute(parse_commands(
          "<part file='" + (model / "part.urdf").string() + "' name='PART' insert_at='ROOT'/>", "s.xml", scene));
    } catch (const InputError&) {  // the robot has nothing else to show
    }
    return inputs.files().contains(model / "../../../other/named.stl");
  };
  CHECK_FALSE(reads_it(model, {}));
  CHECK(reads_it(model, {{"other", folder / "other"}}));
  CHECK(reads_it(folder.path(), {}));
}

TEST_SUITE_END();
