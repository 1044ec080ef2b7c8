#include <tope/common/error.hpp>
#include <tope/robot/collision_geometry.hpp>

#include <coal/BVH/BVH_model.h>
#include <coal/mesh_loader/loader.h>
#include <exception>

namespace tope::shape {

ConvexHull ConvexHull::of_mesh(const std::filesystem::path& file) {
  try {
    const coal::BVHModelPtr_t mesh = coal::MeshLoader().load(file.string());
    return {.points = *mesh->vertices};
  } catch (const std::exception& error) {
    throw ConfigError(file.string() + ": no such mesh file, or it cannot be read: " + error.what());
  }
}

}  // namespace tope::shape
