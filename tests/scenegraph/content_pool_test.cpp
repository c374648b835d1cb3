// Equal content becomes one object, which is removed when nothing uses it.
#include <doctest/doctest.h>

#include <cstdlib>
#include <limits>

#include <simvis/content_pool.h>
#include <simvis/error.h>

TEST_SUITE_BEGIN("scenegraph");

using namespace simvis;

namespace {

Mesh triangle() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.attributes.resize(3);
  mesh.indices = {0, 1, 2};
  compute_bounds(mesh);
  return mesh;
}

Texture picture() {
  Texture texture;
  texture.width = texture.height = 2;
  texture.rgba.assign(16, 200);
  return texture;
}

}  // namespace

TEST_CASE("equal meshes are one object regardless of names; each difference makes another") {
  ContentPool pool;
  const auto first = pool.intern(triangle());
  Mesh named = triangle();
  named.name = "other";
  CHECK(pool.intern(std::move(named)) == first);

  Mesh moved = triangle(), colored = triangle(), turned = triangle(), lines = triangle();
  moved.positions[1].x = 2;
  colored.attributes[2].color.a = 0.5f;
  turned.indices = {0, 2, 1};
  lines.topology = Topology::points;
  CHECK(pool.intern(std::move(moved)) != first);
  CHECK(pool.intern(std::move(colored)) != first);
  CHECK(pool.intern(std::move(turned)) != first);
  CHECK(pool.intern(std::move(lines)) != first);
}

TEST_CASE("pools share equal content of the same name, and hold it no longer than it is used") {
  ContentPool one, other;
  std::weak_ptr<const Mesh> released;
  {
    const auto mesh = one.intern(triangle());
    released = mesh;
    CHECK(other.intern(triangle()) == mesh);
    // Messages of a simulation do not depend on what other simulations call their meshes.
    Mesh named = triangle();
    named.name = "named";
    ContentPool third;
    CHECK(third.intern(std::move(named))->name == "named");
  }
  CHECK(released.expired());

  const auto texture = one.intern(picture());
  CHECK(other.intern(picture()) == texture);
  Material painted, same;
  painted.base_color_texture = same.base_color_texture = texture;
  const auto material = one.intern(std::move(painted));
  CHECK(other.intern(std::move(same)) == material);
}

TEST_CASE("a NaN equals itself") {
  ContentPool pool;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Mesh a = triangle(), b = triangle();
  a.attributes[0].uv[0].x = b.attributes[0].uv[0].x = nan;
  CHECK(pool.intern(std::move(a)) == pool.intern(std::move(b)));
  Material c, d;
  c.alpha_cutoff = d.alpha_cutoff = nan;
  CHECK(pool.intern(std::move(c)) == pool.intern(std::move(d)));
}

TEST_CASE("textures compare by pixels and sampler") {
  ContentPool pool;
  const auto first = pool.intern(picture());
  CHECK(pool.intern(picture()) == first);
  Texture pixel = picture(), sampler = picture(), shape = picture();
  pixel.rgba[7] = 201;
  sampler.sampler.wrap_v = Wrap::clamp_to_edge;
  shape.width = 4;
  shape.height = 1;
  CHECK(pool.intern(std::move(pixel)) != first);
  CHECK(pool.intern(std::move(sampler)) != first);
  CHECK(pool.intern(std::move(shape)) != first);
}

TEST_CASE("materials compare by value and by their textures") {
  ContentPool pool;
  const auto texture = pool.intern(picture());
  Material a, b, other_texture, other_uv, unlit, faded, glossy, metal, relief;
  a.base_color_texture = b.base_color_texture = other_uv.base_color_texture = unlit.base_color_texture = texture;
  faded.base_color_texture = glossy.base_color_texture = texture;
  b.name = "b";
  other_texture.base_color_texture = std::make_shared<Texture>(picture());
  other_uv.uv_transform[2].x = 0.5f;
  unlit.unlit = true;
  faded.opacity = 0.5f;
  glossy.roughness = 0.5f;
  metal.base_color_texture = relief.base_color_texture = texture;
  metal.metallic = 0.5f;
  relief.map(MapKind::normal).texture = texture;
  const auto first = pool.intern(std::move(a));
  CHECK(pool.intern(std::move(b)) == first);
  CHECK(pool.intern(std::move(other_texture)) != first);
  CHECK(pool.intern(std::move(other_uv)) != first);
  CHECK(pool.intern(std::move(unlit)) != first);
  CHECK(pool.intern(std::move(faded)) != first);
  CHECK(pool.intern(std::move(glossy)) != first);
  CHECK(pool.intern(std::move(metal)) != first);
  CHECK(pool.intern(std::move(relief)) != first);
}

TEST_CASE("the pool keeps nothing alive") {
  ContentPool pool;
  std::weak_ptr<const Mesh> watched;
  {
    const auto mesh = pool.intern(triangle());
    watched = mesh;
    CHECK(pool.intern(triangle()) == mesh);
  }
  CHECK(watched.expired());
  CHECK(pool.intern(triangle()) != nullptr);
}

TEST_CASE("many added and removed contents keep their identity") {
  constexpr int kMany = 5000;
  ContentPool pool;
  std::vector<std::shared_ptr<const Mesh>> kept;
  for (int i = 0; i < kMany; ++i) {
    Mesh mesh = triangle();
    mesh.positions[0].z = static_cast<float>(i);
    auto shared = pool.intern(std::move(mesh));
    if (i % 10 == 0) kept.push_back(shared);
  }
  for (std::size_t k = 0; k < kept.size(); ++k) {
    Mesh mesh = triangle();
    mesh.positions[0].z = static_cast<float>(10 * k);
    CHECK(pool.intern(std::move(mesh)) == kept[k]);
  }
}

TEST_CASE("the pictures of a pool have a limit together, which is an error of the machine") {
  ::setenv("SIMVIS_PICTURE_MIB", "2", 1);
  ContentPool pool;
  const auto of_one_mib = [](std::uint8_t grey) {
    Texture texture;
    texture.width = texture.height = 512;
    texture.rgba.assign(1 << 20, grey);
    return texture;
  };
  const auto first = pool.intern(of_one_mib(1)), second = pool.intern(of_one_mib(2));
  CHECK(pool.intern(of_one_mib(2)) == second);  // is there already
  CHECK_THROWS_WITH_AS(pool.intern(of_one_mib(3)),
                       "the pictures of the scene take more than 2 MiB when they are decoded, which is the limit; the "
                       "variable SIMVIS_PICTURE_MIB sets another",
                       MachineError);
  ::unsetenv("SIMVIS_PICTURE_MIB");
  CHECK(pool.intern(of_one_mib(3))->rgba[0] == 3);
}

TEST_SUITE_END();
