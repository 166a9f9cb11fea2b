#include "scene_parts.hpp"

#include <map>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/meshes/mesh_file.hpp"
#include "engine/io/referenced_file.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// Counts the parts of one scene, because repeats, aliases and places multiply: what is refused one by one may still be
/// without bound in sum.
class PartCount {
 public:
  /// To be called before anything is made of the parts.
  void add(const YamlValue& value, std::size_t parts) {
    if (parts > kMaxSceneParts - parts_) {
      value.refuse("the scene has more than " + std::to_string(kMaxSceneParts) + " parts");
    }
    parts_ += parts;
  }

 private:
  std::size_t parts_ = 0;
};

std::size_t read_repeat_count(YamlMapping& repeat, PartCount& parts) {
  const YamlValue count = repeat.require("count");
  if (count.count() < 1 || count.count() > kMaxSceneParts) {
    count.refuse("must be 1 to " + std::to_string(kMaxSceneParts));
  }
  parts.add(count, count.count() - 1);
  return count.count();
}

/// `repeat: {count: 5, step: [2, 0]}` sets copies of a part, each a step further.
std::vector<Point2> read_offsets(YamlMapping& part, PartCount& parts) {
  parts.add(part.value(), 1);
  const std::optional<YamlValue> repeat = part.find("repeat");
  if (!repeat) {
    return {Point2(0.0, 0.0)};
  }
  YamlMapping mapping(*repeat);
  const std::size_t count = read_repeat_count(mapping, parts);
  const Point2 step_m = mapping.require("step").point();
  mapping.finish();
  std::vector<Point2> offsets_m;
  for (std::size_t i = 0; i < count; ++i) {
    offsets_m.emplace_back(static_cast<double>(i) * step_m);
  }
  return offsets_m;
}

template <class Part>
void add_copies(const YamlValue& value, const Part& part, const std::vector<Point2>& offsets_m,
                std::vector<Part>& parts) {
  for (const Point2& offset_m : offsets_m) {
    Part copy = part;
    copy.centre_m += offset_m;
    value.require_none(validate(copy));
    parts.push_back(copy);
  }
}

void read_box(const YamlValue& value, PartCount& parts, std::vector<sim::Box>& boxes) {
  YamlMapping mapping(value);
  sim::Box box;
  box.centre_m = mapping.require("centre").point();
  box.size_m = mapping.require("size").point();
  box.height_m = mapping.require("height").number(kLength);
  mapping.read("base", kLength, box.base_m);
  mapping.read("yaw", kAngle, box.yaw_rad);
  const std::vector<Point2> offsets_m = read_offsets(mapping, parts);
  mapping.finish();
  add_copies(value, box, offsets_m, boxes);
}

void read_cylinder(const YamlValue& value, PartCount& parts, std::vector<sim::Cylinder>& cylinders) {
  YamlMapping mapping(value);
  sim::Cylinder cylinder;
  cylinder.centre_m = mapping.require("centre").point();
  cylinder.radius_m = mapping.require("radius").number(kLength);
  cylinder.height_m = mapping.require("height").number(kLength);
  mapping.read("base", kLength, cylinder.base_m);
  read_given(mapping, "sides", [&](const YamlValue& sides) { cylinder.sides = static_cast<int>(sides.count()); });
  const std::vector<Point2> offsets_m = read_offsets(mapping, parts);
  mapping.finish();
  add_copies(value, cylinder, offsets_m, cylinders);
}

// Into a scene or an object of it.
template <class Target>
void read_boxes_and_cylinders(YamlMapping& mapping, PartCount& parts, Target& target) {
  for (const YamlValue& box : mapping.list("boxes")) read_box(box, parts, target.boxes);
  for (const YamlValue& cylinder : mapping.list("cylinders")) read_cylinder(cylinder, parts, target.cylinders);
}

// Whether the value is the first of two words.
bool is_first(const YamlValue& value, const std::string& first, const std::string& second) {
  const std::string text = value.text();
  if (text != first && text != second) value.refuse("'" + text + "' is neither " + first + " nor " + second);
  return text == first;
}

sim::DoorLeaf read_leaf(const YamlValue& value) {
  YamlMapping mapping(value);
  sim::DoorLeaf leaf;
  leaf.angle_rad = mapping.require("angle").number(kAngle);
  mapping.read("thickness", kLength, leaf.thickness_m);
  read_given(mapping, "hinge", [&](const YamlValue& hinge) { leaf.hinge_at_far = !is_first(hinge, "near", "far"); });
  mapping.finish();
  return leaf;
}

sim::Door read_door(const YamlValue& value) {
  YamlMapping mapping(value);
  sim::Door door;
  read_given(mapping, "leg", [&](const YamlValue& leg) { door.leg = leg.count(); });
  door.from_m = mapping.require("from").number(kLength);
  mapping.read("width", kLength, door.width_m);
  mapping.read("height", kLength, door.height_m);
  read_given(mapping, "leaf", [&](const YamlValue& leaf) { door.leaf = read_leaf(leaf); });
  mapping.finish();
  return door;
}

/// A row of windows is written once: `repeat: {count: 4, step: 2.5}` sets each a step further along the leg.
void read_windows(const YamlValue& value, PartCount& parts, sim::Wall& wall) {
  YamlMapping mapping(value);
  sim::Door window{.width_m = 1.2, .sill_m = 0.9};
  read_given(mapping, "leg", [&](const YamlValue& leg) { window.leg = leg.count(); });
  window.from_m = mapping.require("from").number(kLength);
  mapping.read("width", kLength, window.width_m);
  mapping.read("sill", kLength, window.sill_m);
  mapping.read("head", kLength, window.height_m);
  std::size_t count = 1;
  double step_m = 0.0;
  parts.add(value, 1);
  read_given(mapping, "repeat", [&](const YamlValue& repeat) {
    YamlMapping row(repeat);
    count = read_repeat_count(row, parts);
    step_m = row.require("step").number(kLength);
    row.finish();
  });
  mapping.finish();
  if (!(window.sill_m > 0.0)) {
    value.refuse("sill must be above 0: an opening down to the floor is a door");
  }
  for (std::size_t i = 0; i < count; ++i) {
    wall.doors.push_back(window);
    window.from_m += step_m;
  }
}

void read_wall_sizes(YamlMapping& mapping, sim::Wall& wall) {
  mapping.read("thickness", kLength, wall.thickness_m);
  mapping.read("base", kLength, wall.base_m);
  mapping.read("height", kLength, wall.height_m);
}

sim::Wall read_wall(const YamlValue& value, const sim::Wall& defaults, PartCount& parts) {
  YamlMapping mapping(value);
  sim::Wall wall = defaults;
  for (const YamlValue& point : mapping.require("points").entries()) {
    parts.add(point, 1);
    wall.points_m.push_back(point.point());
  }
  mapping.read("closed", wall.is_closed);
  read_wall_sizes(mapping, wall);
  for (const YamlValue& door : mapping.list("doors")) {
    parts.add(door, 1);
    wall.doors.push_back(read_door(door));
  }
  for (const YamlValue& window : mapping.list("windows")) {
    read_windows(window, parts, wall);
  }
  mapping.finish();
  value.require_none(validate(wall));
  return wall;
}

double metres_per_unit(const YamlValue& unit) {
  const std::optional<double> metres = parse_quantity("1 " + unit.text(), Unit::kMetre, nullptr);
  if (!metres) {
    unit.refuse("'" + unit.text() + "' is no unit of length: use m, cm or mm");
  }
  return *metres;
}

sim::TriangleMesh read_placed_mesh(const YamlValue& value, std::size_t max_triangles) {
  YamlMapping mapping(value);
  const YamlValue file = mapping.require("file");
  sim::MeshPlacement placement;
  mapping.read("scale", kNumber, placement.scale);
  read_given(mapping, "unit", [&](const YamlValue& unit) { placement.scale *= metres_per_unit(unit); });
  if (const auto position = mapping.find("position")) {
    const std::vector<YamlValue> coordinates = position->entries();
    if (coordinates.size() != 3) {
      position->refuse("a place [x, y, z] is expected here");
    }
    placement.position_m = {coordinates[0].number(kLength), coordinates[1].number(kLength),
                            coordinates[2].number(kLength)};
  }
  mapping.read("yaw", kAngle, placement.yaw_rad);
  read_given(mapping, "up", [&](const YamlValue& up) { placement.y_is_up = is_first(up, "y", "z"); });
  mapping.finish();
  if (const std::string fault = fault_of_reference(value.file(), file.text()); !fault.empty()) {
    file.refuse(fault);
  }
  const MeshFile mesh = read_mesh(referenced_path(value.file(), file.text()), {max_triangles, interrupted});
  return sim::placed_mesh(mesh.vertices, mesh.triangles, placement);
}

sim::Wall read_wall_defaults(YamlMapping& root) {
  sim::Wall defaults;
  if (const auto value = root.find("wall_defaults")) {
    YamlMapping mapping(*value);
    read_wall_sizes(mapping, defaults);
    mapping.finish();
  }
  return defaults;
}

/// Boxes and cylinders that belong together, in a frame of their own.
struct Object {
  std::vector<sim::Box> boxes;
  std::vector<sim::Cylinder> cylinders;
};
using Objects = std::map<std::string, Object>;

void read_object(const YamlValue& value, PartCount& parts, Objects& objects) {
  YamlMapping mapping(value);
  parts.add(value, 1);
  const YamlValue name = mapping.require("name");
  const auto [entry, is_new] = objects.try_emplace(name.text());
  if (!is_new) {
    name.refuse("there are two objects '" + name.text() + "'");
  }
  read_boxes_and_cylinders(mapping, parts, entry->second);
  mapping.finish();
}

const Object& object_named(const YamlValue& name, const Objects& objects) {
  if (const auto found = objects.find(name.text()); found != objects.end()) {
    return found->second;
  }
  std::vector<std::string> names;
  for (const auto& [known, object] : objects) names.push_back(known);
  name.refuse("there is no object '" + name.text() + "'" + did_you_mean(name.text(), names));
}

void read_place(const YamlValue& value, const Objects& objects, PartCount& parts, sim::Scene& scene) {
  YamlMapping mapping(value);
  const Object& object = object_named(mapping.require("object"), objects);
  const Point2 at_m = mapping.require("at").point();
  Pose2 T_map_object{at_m.x(), at_m.y(), 0.0};
  mapping.read("yaw", kAngle, T_map_object.theta_rad);
  const std::vector<Point2> offsets_m = read_offsets(mapping, parts);
  mapping.finish();
  parts.add(value, offsets_m.size() * (object.boxes.size() + object.cylinders.size()));
  for (sim::Box box : object.boxes) {
    box.centre_m = T_map_object * box.centre_m;
    box.yaw_rad += T_map_object.theta_rad;
    add_copies(value, box, offsets_m, scene.boxes);
  }
  for (sim::Cylinder cylinder : object.cylinders) {
    cylinder.centre_m = T_map_object * cylinder.centre_m;
    add_copies(value, cylinder, offsets_m, scene.cylinders);
  }
}

void read_objects(YamlMapping& root, PartCount& parts, sim::Scene& scene) {
  Objects objects;
  for (const YamlValue& object : root.list("objects")) read_object(object, parts, objects);
  for (const YamlValue& place : root.list("place")) read_place(place, objects, parts, scene);
}

void read_meshes(YamlMapping& root, PartCount& parts, sim::Scene& scene) {
  std::size_t triangles = 0;
  for (const YamlValue& mesh : root.list("meshes")) {
    parts.add(mesh, 1);
    scene.meshes.push_back(read_placed_mesh(mesh, sim::kMaxTriangles - triangles));
    triangles += scene.meshes.back().triangles.size();
  }
}

}  // namespace

sim::Scene read_scene_parts(YamlMapping& root) {
  sim::Scene scene;
  PartCount parts;
  const sim::Wall wall_defaults = read_wall_defaults(root);
  for (const YamlValue& wall : root.list("walls")) {
    scene.walls.push_back(read_wall(wall, wall_defaults, parts));
  }
  read_boxes_and_cylinders(root, parts, scene);
  read_objects(root, parts, scene);
  read_meshes(root, parts, scene);
  read_given(root, "floor", [&](const YamlValue& floor) { scene.floor_m = floor.number(kLength); });
  read_given(root, "ceiling", [&](const YamlValue& ceiling) { scene.ceiling_m = ceiling.number(kLength); });
  return scene;
}

}  // namespace gdtslam
