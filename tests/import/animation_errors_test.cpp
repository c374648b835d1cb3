// The element `animation` with commands that fail: the messages, and that nothing is left behind.
#include <doctest/doctest.h>

#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/animated_part.h"

TEST_SUITE_BEGIN("import");

using namespace simvis;
using namespace simvis::test;

TEST_CASE("errors in the command") {
  const GltfBuilder builder = bending_strip();
  const auto error = [&](const std::string& commands) {
    TemporaryFolder folder;
    GltfBuilder still;
    still.triangle();
    write_text(folder / "part.gltf", builder.text());
    write_text(folder / "still.gltf", still.text());
    const std::string xml =
        "<part file='part.gltf' name='P' insert_at='ROOT'/>"
        "<part file='still.gltf' name='STILL' insert_at='ROOT'/>" +
        commands;
    return error_of([&] { build_scene(parse_commands(xml, "s.xml", folder.path())); });
  };
  const std::string play = "<element type='animation' insert_at='ROOT' name=";
  CHECK(contains(error(play + "'A'/>"), "part"));
  CHECK(contains(error(play + "'A' part='STIL'/>"), "there is no part \"STIL\", did you mean \"STILL\"?"));
  CHECK(contains(error(play + "'A' part='STILL'/>"), "part \"STILL\" has no animation (file \""));
  CHECK(contains(error(play + "'A' part='P' repeat='twice'/>"), "expected one of: loop, once"));
  CHECK(contains(
      error(play + "'A' part='P'/>" + play + "'B' part='P'/>"),
      "the animation moves nodes or meshes that the element \"A\" already moves in part \"P\" (expected animations of "
      "different nodes and meshes)"));
  CHECK(contains(error("<element type='animation' insert_at='ROUTE' name='A' part='P'/>"), "ROUTE"));
}

TEST_CASE("a later failure removes the animation") {
  TemporaryFolder folder;
  write_text(folder / "part.gltf", bending_strip().text());
  BuiltScene built =
      build_scene(parse_commands("<part file='part.gltf' name='P' insert_at='ROOT' up='z'/>", "s.xml", folder.path()));
  Flattener flattener(built.scene.root());
  const DrawList before = flattener.update();
  SceneBuilder builder(built, {});
  const std::string play = "<element type='animation' name='WALK' insert_at='ROOT' part='P' time='1'/>";
  const auto execute = [&](const std::string& xml) { builder.execute(parse_commands(xml, "t.xml", folder.path())); };
  CHECK(contains(error_of([&] { execute(play + "<element type='nothing' name='X' insert_at='ROOT'/>"); }), "nothing"));
  const DrawList after = flattener.update();
  CHECK(after.meshes == before.meshes);
  CHECK(after.world_from_node == before.world_from_node);
  execute(play);
  CHECK(flattener.update().meshes != before.meshes);
}

TEST_SUITE_END();
