#include <simvis/draw_list.h>

#include <doctest/doctest.h>

#include <functional>
#include <sstream>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

std::shared_ptr<Mesh> triangle() {
  auto mesh = std::make_shared<Mesh>();
  mesh->name = "triangle";
  mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, -3}, {50, 50, 50}};
  mesh->attributes.resize(4);
  mesh->indices = {0, 1, 2};
  compute_bounds(*mesh);
  return mesh;
}

std::shared_ptr<Material> red() {
  auto texture = std::make_shared<Texture>();
  texture->name = "grain";
  texture->width = texture->height = 1;
  texture->rgba = {1, 2, 3, 4};
  auto material = std::make_shared<Material>();
  material->name = "red";
  material->base_color = {1, 0, 0, 1};
  material->base_color_texture = texture;
  return material;
}

struct Parts {
  std::shared_ptr<Mesh> mesh = triangle();
  std::shared_ptr<Material> material = red();
};

DrawList list_of(const Parts& parts) {
  DrawList list;
  list.items = {{0, 0, 0}, {0, 0, 1}};
  list.lights = {{Light{}, 1}};
  list.world_from_node = {glm::dmat4(1), glm::dmat4(2)};
  list.meshes = {parts.mesh};
  list.materials = {parts.material};
  list.material_revision = {0};
  return list;
}

}  // namespace

TEST_CASE("bounds are those of the positions that indices use") {
  const auto mesh = triangle();
  CHECK(mesh->bounds_min == glm::vec3(0, 0, -3));
  CHECK(mesh->bounds_max == glm::vec3(1, 2, 0));
  Mesh empty;
  empty.bounds_min = glm::vec3(7);
  compute_bounds(empty);
  CHECK(empty.bounds_min == glm::vec3(0));
  CHECK(empty.bounds_max == glm::vec3(0));
}

TEST_CASE("lists with equal content are equal for any owner and any revisions") {
  DrawList a = list_of({}), b = list_of({});
  CHECK(same_content(a, b));
  CHECK(content_hash(a) == content_hash(b));
  b.revisions.structure = 9;
  b.material_revision[0] = 4;
  CHECK(same_content(a, b));
  CHECK(content_hash(a) == content_hash(b));
}

TEST_CASE("comparison and hash detect any change of content") {
  const DrawList original = list_of({});
  const std::function<void(DrawList&, Parts&)> changes[] = {
      [](DrawList& l, Parts&) { l.items[1].transform = 0; },
      [](DrawList& l, Parts&) { l.items.pop_back(); },
      [](DrawList& l, Parts&) { l.lights[0].light.intensity = 2; },
      [](DrawList& l, Parts&) { l.lights[0].light.direction.y = 1; },
      [](DrawList& l, Parts&) { l.lights[0].transform = 0; },
      [](DrawList& l, Parts&) { l.world_from_node[1][3].x = 1e-300; },
      [](DrawList& l, Parts&) { l.world_from_node[0][0].y = -0.0; },
      [](DrawList& l, Parts&) { l.environment.ambient.x = 0; },
      [](DrawList& l, Parts&) { l.environment.background.z = 0; },
      [](DrawList&, Parts& p) { p.mesh->positions[1].x = 2; },
      [](DrawList&, Parts& p) { p.mesh->attributes[2].uv[1].y = 2; },
      [](DrawList&, Parts& p) { p.mesh->indices[1] = 0; },
      [](DrawList&, Parts& p) { p.mesh->topology = Topology::points; },
      [](DrawList&, Parts& p) { p.material->emissive.y = 1; },
      [](DrawList&, Parts& p) { p.material->alpha_mode = AlphaMode::mask; },
      [](DrawList&, Parts& p) { p.material->uv_transform[2][1] = 0.5f; },
      [](DrawList&, Parts& p) { p.material->opacity = 0.5f; },
      [](DrawList&, Parts& p) { p.material->roughness = 0.5f; },
      [](DrawList&, Parts& p) { p.material->metallic = 0.5f; },
      [](DrawList&, Parts& p) { p.material->normal_scale = 0.5f; },
      [](DrawList&, Parts& p) { p.material->occlusion_strength = 0.5f; },
      [](DrawList&, Parts& p) { p.material->maps[1].texture = p.material->base_color_texture; },
      [](DrawList&, Parts& p) { p.material->map(MapKind::emissive).uv_transform[2][1] = 0.5f; },
      [](DrawList&, Parts& p) { p.material->base_color_texture = nullptr; },
      [](DrawList&, Parts& p) {
        auto texture = std::make_shared<Texture>(*p.material->base_color_texture);
        texture->rgba[3] = 5;
        p.material->base_color_texture = texture;
      },
      [](DrawList&, Parts& p) {
        auto texture = std::make_shared<Texture>(*p.material->base_color_texture);
        texture->sampler.wrap_v = Wrap::clamp_to_edge;
        p.material->base_color_texture = texture;
      },
  };
  int number = 0;
  for (const auto& change : changes) {
    CAPTURE(number++);
    Parts parts;
    DrawList list = list_of(parts);
    change(list, parts);
    CHECK(!same_content(original, list));
    CHECK(content_hash(original) != content_hash(list));
  }
}

TEST_CASE("the hash is FNV-1a: an empty list gives the value of its known bytes") {
  // Five counts of zero (8 bytes each), then the six floats of the environment, all set to zero: 64 zero bytes, each of
  // which multiplies the offset basis by the prime.
  DrawList list;
  list.environment.ambient = list.environment.background = glm::vec3(0);
  std::uint64_t expected = 0xcbf29ce484222325ull;
  for (int i = 0; i < 5 * 8 + 6 * 4; ++i) expected *= 0x100000001b3ull;
  CHECK(content_hash(list) == expected);
}

TEST_CASE("values that compare equal hash equal") {
  Parts parts;
  parts.material->emissive = {0.0f, 0, 0};
  const DrawList plus = list_of(parts);
  Parts negative;
  negative.material->emissive = {-0.0f, 0, 0};
  const DrawList minus = list_of(negative);
  CHECK(same_content(plus, minus));
  CHECK(content_hash(plus) == content_hash(minus));
}

TEST_CASE("a list prints its content") {
  std::ostringstream out;
  out << list_of({});
  const std::string text = out.str();
  for (const char* part :
       {"2 items", "item 1: mesh 0, material 0, transform 1", "light 0: directional",
        "\"triangle\" triangles, 4 vertices, 3 indices", "\"red\" opaque", "texture \"grain\" 1 x 1", "at (0 0 0)"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  }
}

TEST_SUITE_END();
