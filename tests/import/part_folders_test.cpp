// One rule for what part files of all formats name, however they write it: the file lies in a folder of the part.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "engine/base/input_log.h"
#include "engine/base/read_fence.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
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

// What a robot shows, whose files may lie anywhere in its package, wheel or repository.
bool is_of_visual(const NamingPart& part) {
  const std::string format = part.format;
  return format == "URDF: mesh" || format == "URDF: picture" || format == "SDF: mesh" || format == "SDF: heights" ||
         format == "MJCF: mesh" || format == "MJCF: picture";
}

// A robot in top/repository/robots/arm, its file in top/repository/hands/meshes, and one outside, in top/other.
struct NeighbouringFiles {
  explicit NeighbouringFiles(const NamingPart& part) : name("named." + part.named) {
    for (const fs::path& file : {within(), outside()}) write_named(file);
    fs::create_directories(robot());
  }
  fs::path robot() const { return folder / "top/repository/robots/arm"; }
  fs::path within() const { return folder / ("top/repository/hands/meshes/" + name); }
  fs::path outside() const { return folder / ("top/other/" + name); }
  bool reads_within(const NamingPart& part) const {
    return reads(robot(), part, "../../hands/meshes/" + name, within());
  }
  bool reads_outside(const NamingPart& part) const { return reads(robot(), part, "../../../other/" + name, outside()); }
  TemporaryFolder folder;
  std::string name;
};

TEST_CASE("a robot reads the meshes and pictures of its package, wheel or repository, and nothing else of it") {
  int visuals = 0, others = 0;
  for (const NamingPart& part : naming_parts()) {
    if (part.needs_coin && !has_coin()) continue;
    CAPTURE(std::string(part.format));
    for (const char* const mark :
         {"", "repository/package.xml", "repository/pyproject.toml", "repository/.git", "repository/.git/HEAD",
          "repository-1.0.dist-info/RECORD", "repository/robots/pyproject.toml"}) {
      CAPTURE(std::string(mark));
      const NeighbouringFiles files(part);
      if (*mark != '\0') {
        fs::create_directories((files.folder / "top" / mark).parent_path());
        write_text(files.folder / "top" / mark, "");
      }
      const std::string where = mark;
      const bool is_nearer = where.starts_with("repository/robots/"), is_package = where == "repository/package.xml";
      const bool may = !where.empty() && !is_nearer && (is_package || is_of_visual(part));
      CHECK(files.reads_within(part) == may);
      CHECK_FALSE(files.reads_outside(part));
      ++(is_of_visual(part) ? visuals : others);
    }
  }
  CHECK(visuals == 6 * 7);
  CHECK(others > 50);
}

TEST_CASE("a mesh of a robot finds its pictures in the robot's repository") {
  const TemporaryFolder folder;
  write_named(folder / "repository/textures/named.png");
  write_text(folder / "repository/.git", "");
  fs::create_directories(folder / "repository/hands/a/meshes");
  write_text(folder / "repository/hands/a/meshes/part.mtl", "newmtl m\nmap_Kd ../../../textures/named.png\n");
  write_text(folder / "repository/hands/a/meshes/hand.obj", kNamingBox);
  const NamingPart robot{"URDF: mesh", "part.urdf", urdf_with("<geometry><mesh filename='@'/></geometry>"), "", "", ""};
  const fs::path model = folder / "repository/robots/arm";
  fs::create_directories(model);
  const auto reads_picture = [&] {
    return reads(model, robot, "../../hands/a/meshes/hand.obj", folder / "repository/textures/named.png");
  };
  CHECK(reads_picture());
  fs::remove(folder / "repository/.git");
  CHECK_FALSE(reads_picture());
}

TEST_CASE("no mark opens a home folder or one that another user has marked, and no link leads out of a root") {
  int tried = 0;
  const char* const before = std::getenv("HOME");
  const std::string kept = before == nullptr ? "" : before;
  for (const NamingPart& part : naming_parts()) {
    if (!is_of_visual(part)) continue;
    CAPTURE(std::string(part.format));
    for (const char* const mark : {"package.xml", "pyproject.toml", ".git"}) {
      CAPTURE(std::string(mark));
      const NeighbouringFiles files(part);
      const fs::path root = files.folder / "top/repository";
      write_text(root / mark, "");
      CHECK(files.reads_within(part));
      // The archive of a stranger may have been unpacked in the home folder, and a user may keep that in git.
      for (const char* const home : {"top/repository", "top/repository/robots"}) {
        ::setenv("HOME", (files.folder / home).c_str(), 1);
        CHECK_FALSE(files.reads_within(part));
      }
      before == nullptr ? ::unsetenv("HOME") : ::setenv("HOME", kept.c_str(), 1);
      fs::rename(files.within(), files.within().string() + ".moved");
      fs::create_symlink(files.outside(), files.within());
      CHECK_FALSE(reads(files.robot(), part, "../../hands/meshes/" + files.name, files.outside()));
      fs::remove(files.within());
      fs::rename(files.within().string() + ".moved", files.within());
      ++tried;
      constexpr uid_t kOther = 54321;
      if (::lchown((root / mark).c_str(), kOther, static_cast<gid_t>(-1)) != 0) continue;  // only root may
      CHECK_FALSE(files.reads_within(part));
      CHECK(::lchown(root.c_str(), kOther, static_cast<gid_t>(-1)) == 0);
      CHECK(files.reads_within(part));  // it is his own folder
    }
  }
  CHECK(tried == 18);
}

TEST_CASE("a wheel's mark opens no folder of the home folder, and never all wheels") {
  const char* const before = std::getenv("HOME");
  const std::string kept = before == nullptr ? "" : before;
  for (const NamingPart& part : naming_parts()) {
    if (!is_of_visual(part)) continue;
    CAPTURE(std::string(part.format));
    const NeighbouringFiles files(part);
    fs::create_directories(files.folder / "top/repository-1.0.dist-info");
    CHECK(files.reads_within(part));
    ::setenv("HOME", (files.folder / "top").c_str(), 1);
    CHECK_FALSE(files.reads_within(part));
    before == nullptr ? ::unsetenv("HOME") : ::setenv("HOME", kept.c_str(), 1);
    CHECK_FALSE(files.reads_outside(part));  // another wheel
  }
}

// A robot with `shown` boxes and `missing` visuals whose mesh has this name.
std::string robot_text(const std::string& format, int shown, int missing, const std::string& name) {
  std::string text, geoms;
  for (int i = 0; i < shown + missing; ++i) {
    const bool is_box = i < shown;
    if (format == "urdf") {
      text += "<visual><geometry>" + (is_box ? std::string("<box size='1 1 1'/>") : "<mesh filename='" + name + "'/>") +
              "</geometry></visual>";
    } else if (format == "sdf") {
      text += "<visual name='v" + std::to_string(i) + "'><geometry>" +
              (is_box ? std::string("<box><size>1 1 1</size></box>") : "<mesh><uri>" + name + "</uri></mesh>") +
              "</geometry></visual>";
    } else {
      geoms += is_box ? "<geom size='1'/>" : "<geom type='mesh' mesh='m'/>";
    }
  }
  if (format == "urdf") return "<robot name='r'><link name='l'>" + text + "</link></robot>";
  if (format == "sdf") return "<sdf version='1.9'><model name='m'><link name='l'>" + text + "</link></model></sdf>";
  return "<mujoco><asset><mesh name='m' file='" + name + "'/></asset><worldbody>" + geoms + "</worldbody></mujoco>";
}

TEST_CASE("visuals outside of the folders are one warning with the folder to add, and most visuals missing an error") {
  const TemporaryFolder folder;
  write_named(folder / "hands/meshes/named.stl");
  fs::create_directories(folder / "robots/arm/urdf");
  const auto load = [&](const std::string& format, int shown, int missing, const std::string& name,
                        const std::string& attributes) {
    const std::string file = "robot." + (format == "mjcf" ? "xml" : format);
    write_text(folder / "robots/arm/urdf" / file, robot_text(format, shown, missing, name));
    BuiltScene built =
        build_scene(parse_commands("<part file='" + file + "' name='PART' insert_at='ROOT' " + attributes + "/>",
                                   "s.xml", folder / "robots/arm/urdf"));
    return built.scene.warnings();
  };
  for (const std::string format : {"urdf", "sdf", "mjcf"}) {
    CAPTURE(format);
    const std::vector<std::string> warnings = load(format, 3, 3, "../../../hands/meshes/named.stl", "");
    REQUIRE(warnings.size() == 1);
    CHECK(contains(warnings[0],
                   ": 3 visuals are left out: their files lie outside the folders of the part; --package "
                   "NAME=" +
                       (folder / "hands/meshes").string() + " adds the folder"));
    for (const std::string name : {"../../../hands/meshes/named.stl", "not_there.stl"}) {
      CAPTURE(name);
      const std::string error = error_of([&] { load(format, 1, 2, name, ""); });
      CHECK(contains(error, "only 1 of its 3 visuals can be shown: "));
      CHECK(contains(error, "missing_visuals=\"any\" on the part shows what there is"));
      CHECK(contains(error_of([&] { load(format, 0, 2, name, ""); }), "none of its visuals can be shown: "));
      CHECK_FALSE(load(format, 1, 2, name, "missing_visuals='any'").empty());
      CHECK_FALSE(load(format, 0, 2, name, "missing_visuals='any'").empty());
    }
  }
  write_named(folder / "robots/arm/urdf/part.stl");
  const auto of_mesh = [&] {
    build_scene(parse_commands("<part file='part.stl' name='P' insert_at='ROOT' missing_visuals='any'/>", "s.xml",
                               folder / "robots/arm/urdf"));
  };
  CHECK(contains(error_of(of_mesh), "attribute \"missing_visuals\": it is for robots"));
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
