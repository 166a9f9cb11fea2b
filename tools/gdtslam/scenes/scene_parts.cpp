#include "scene_parts.hpp"

#include <map>
#include <memory>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/meshes/mesh_file.hpp"
#include "engine/io/referenced_file.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

/// Counts the parts of one scene. Repeats, aliases and places multiply, so limits on each alone do not bound the sum.
class PartCount {
 public:
  /// Call it before creating the parts.
  void add(const YamlValue& value, std::size_t parts) {
    if (parts > kMaxSceneParts - parts_) {
      value.refuse("the scene has more than " + std::to_string(kMaxSceneParts) + " parts");
    }
    parts_ += parts;
  }

 private:
  std::size_t parts_ = 0;
};

std::size_t read_repeat_count(const YamlValue& count, PartCount& parts) {
  if (count.count() < 1 || count.count() > kMaxSceneParts) {
    count.refuse("must be 1 to " + std::to_string(kMaxSceneParts));
  }
  parts.add(count, count.count() - 1);
  return count.count();
}

/// `repeat: {count: 5, step: [2, 0]}` adds copies of a part, each a step further.
YamlField repeat_field(PartCount& parts, std::vector<Point2>& offsets_m) {
  return {"repeat", [&](const YamlValue& repeat) {
            std::size_t count = 1;
            Point2 step_m(0.0, 0.0);
            read_fields(repeat,
                        {required({"count", [&](const YamlValue& value) { count = read_repeat_count(value, parts); }}),
                         required({"step", step_m})});
            for (std::size_t i = 1; i < count; ++i) offsets_m.emplace_back(static_cast<double>(i) * step_m);
          }};
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
  parts.add(value, 1);
  sim::Box box;
  std::vector<Point2> offsets_m{{0.0, 0.0}};
  read_fields(value, {required({"centre", box.centre_m}),
                      required({"size", box.size_m}),
                      required({"height", kLength, box.height_m}),
                      {"base", kLength, box.base_m},
                      {"yaw", kAngle, box.yaw_rad},
                      repeat_field(parts, offsets_m)});
  add_copies(value, box, offsets_m, boxes);
}

void read_cylinder(const YamlValue& value, PartCount& parts, std::vector<sim::Cylinder>& cylinders) {
  parts.add(value, 1);
  sim::Cylinder cylinder;
  std::vector<Point2> offsets_m{{0.0, 0.0}};
  read_fields(value, {required({"centre", cylinder.centre_m}),
                      required({"radius", kLength, cylinder.radius_m}),
                      required({"height", kLength, cylinder.height_m}),
                      {"base", kLength, cylinder.base_m},
                      {"sides", [&](const YamlValue& sides) { cylinder.sides = static_cast<int>(sides.count()); }},
                      repeat_field(parts, offsets_m)});
  add_copies(value, cylinder, offsets_m, cylinders);
}

/// A list whose entries are read by a function.
template <class Read>
YamlField list_field(const char* key, Read read) {
  return {key, [read](const YamlValue& list) {
            for (const YamlValue& entry : list.entries()) read(entry);
          }};
}

// The field `boxes` of a scene or of an object.
template <class Target>
YamlField boxes_field(PartCount& parts, Target& target) {
  return list_field("boxes", [&](const YamlValue& box) { read_box(box, parts, target.boxes); });
}
template <class Target>
YamlField cylinders_field(PartCount& parts, Target& target) {
  return list_field("cylinders", [&](const YamlValue& one) { read_cylinder(one, parts, target.cylinders); });
}

// Whether the value is the first of two words.
bool is_first(const YamlValue& value, const std::string& first, const std::string& second) {
  const std::string text = value.text();
  if (text != first && text != second) value.refuse("'" + text + "' is neither " + first + " nor " + second);
  return text == first;
}

sim::DoorLeaf read_leaf(const YamlValue& value) {
  sim::DoorLeaf leaf;
  read_fields(value, {required({"angle", kAngle, leaf.angle_rad}),
                      {"thickness", kLength, leaf.thickness_m},
                      {"hinge", [&](const YamlValue& hinge) { leaf.hinge_at_far = !is_first(hinge, "near", "far"); }}});
  return leaf;
}

void read_door(const YamlValue& value, PartCount& parts, sim::Wall& wall) {
  parts.add(value, 1);
  sim::Door door;
  read_fields(value, {{"leg", [&](const YamlValue& leg) { door.leg = leg.count(); }},
                      required({"from", kLength, door.from_m}),
                      {"width", kLength, door.width_m},
                      {"height", kLength, door.height_m},
                      {"leaf", [&](const YamlValue& leaf) { door.leaf = read_leaf(leaf); }}});
  wall.doors.push_back(door);
}

/// Reads windows; `repeat: {count: 4, step: 2.5}` makes a row of them along the leg.
void read_windows(const YamlValue& value, PartCount& parts, sim::Wall& wall) {
  parts.add(value, 1);
  sim::Door window{.width_m = 1.2, .sill_m = 0.9};
  std::size_t count = 1;
  double step_m = 0.0;
  const auto read_repeat = [&](const YamlValue& repeat) {
    read_fields(repeat, {required({"count", [&](const YamlValue& given) { count = read_repeat_count(given, parts); }}),
                         required({"step", kLength, step_m})});
  };
  read_fields(value, {{"leg", [&](const YamlValue& leg) { window.leg = leg.count(); }},
                      required({"from", kLength, window.from_m}),
                      {"width", kLength, window.width_m},
                      {"sill", kLength, window.sill_m},
                      {"head", kLength, window.height_m},
                      {"repeat", read_repeat}});
  if (!(window.sill_m > 0.0)) {
    value.refuse("sill must be above 0: an opening down to the floor is a door");
  }
  for (std::size_t i = 0; i < count; ++i) {
    wall.doors.push_back(window);
    window.from_m += step_m;
  }
}

std::vector<YamlField> wall_size_fields(sim::Wall& wall) {
  return {{"thickness", kLength, wall.thickness_m}, {"base", kLength, wall.base_m}, {"height", kLength, wall.height_m}};
}

sim::Wall read_wall(const YamlValue& value, const sim::Wall& defaults, PartCount& parts) {
  sim::Wall wall = defaults;
  std::vector<YamlField> fields = wall_size_fields(wall);
  fields.push_back(required(list_field("points", [&](const YamlValue& point) {
    parts.add(point, 1);
    wall.points_m.push_back(point.point());
  })));
  fields.emplace_back("closed", wall.is_closed);
  fields.push_back(list_field("doors", [&](const YamlValue& door) { read_door(door, parts, wall); }));
  fields.push_back(list_field("windows", [&](const YamlValue& window) { read_windows(window, parts, wall); }));
  read_fields(value, fields);
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

// [x, y, z].
sim::Vec3 read_place3(const YamlValue& value) {
  const std::vector<YamlValue> at = value.entries();
  if (at.size() != 3) value.refuse("a place [x, y, z] is expected here");
  return {at[0].number(kLength), at[1].number(kLength), at[2].number(kLength)};
}

sim::FloorPart read_ramp(const YamlValue& value) {
  sim::Vec3 from_m;
  sim::Vec3 to_m;
  double width_m = 1.0;
  read_fields(value, {required({"from", [&](const YamlValue& place) { from_m = read_place3(place); }}),
                      required({"to", [&](const YamlValue& place) { to_m = read_place3(place); }}),
                      required({"width", kLength, width_m})});
  return sim::make_ramp(from_m, to_m, width_m);
}

sim::FloorPart read_plate(const YamlValue& value) {
  Point2 centre_m;
  Point2 size_m;
  double yaw_rad = 0.0;
  double height_m = 0.0;
  read_fields(value, {required({"centre", centre_m}),
                      required({"size", size_m}),
                      required({"height", kLength, height_m}),
                      {"yaw", kAngle, yaw_rad}});
  return sim::make_plate(centre_m, size_m, yaw_rad, height_m);
}

sim::FloorPart read_sill(const YamlValue& value) {
  Point2 from_m;
  Point2 to_m;
  double width_m = 0.1;
  double height_m = 0.015;
  double base_m = 0.0;
  read_fields(value, {required({"from", from_m}),
                      required({"to", to_m}),
                      {"width", kLength, width_m},
                      {"height", kLength, height_m},
                      {"base", kLength, base_m}});
  return sim::make_sill(from_m, to_m, width_m, height_m, base_m);
}

/// The fields `ramps`, `plates` and `sills`.
template <class Read>
YamlField floor_field(const char* key, PartCount& parts, sim::Scene& scene, Read read) {
  return list_field(key, [&parts, &scene, read](const YamlValue& value) {
    constexpr std::size_t kMost = 1000;  // every beam looks at all of them
    if (scene.floor_parts.size() == kMost) {
      value.refuse("the scene has more than " + std::to_string(kMost) + " ramps, plates and sills");
    }
    parts.add(value, 1);
    scene.floor_parts.push_back(read(value));
    value.require_none(validate(scene.floor_parts.back()));
  });
}

sim::TriangleMesh read_placed_mesh(const YamlValue& value, std::size_t max_triangles) {
  std::string file;
  double per_unit_m = 1.0;
  sim::MeshPlacement placement;
  const auto read_file = [&](const YamlValue& name) {
    file = name.text();
    if (const std::string fault = fault_of_reference(value.file(), file); !fault.empty()) name.refuse(fault);
  };
  const auto read_position = [&](const YamlValue& position) { placement.position_m = read_place3(position); };
  read_fields(value, {required({"file", read_file}),
                      {"scale", kNumber, placement.scale},
                      {"unit", [&](const YamlValue& unit) { per_unit_m = metres_per_unit(unit); }},
                      {"position", read_position},
                      {"yaw", kAngle, placement.yaw_rad},
                      {"up", [&](const YamlValue& up) { placement.y_is_up = is_first(up, "y", "z"); }}});
  placement.scale *= per_unit_m;
  const MeshFile mesh = read_mesh(referenced_path(value.file(), file), {max_triangles, interrupted});
  return sim::placed_mesh(mesh.vertices, mesh.triangles, placement);
}

/// Boxes and cylinders of one object, in its own frame.
struct Object {
  std::vector<sim::Box> boxes;
  std::vector<sim::Cylinder> cylinders;
};
using Objects = std::map<std::string, Object>;

void read_object(const YamlValue& value, PartCount& parts, Objects& objects) {
  parts.add(value, 1);
  std::string name;
  Object object;
  read_fields(value, {required({"name", name}), boxes_field(parts, object), cylinders_field(parts, object)});
  if (!objects.emplace(name, std::move(object)).second) value.refuse("there are two objects '" + name + "'");
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
  parts.add(value, 1);
  Object object;
  Point2 at_m(0.0, 0.0);
  double yaw_rad = 0.0;
  std::vector<Point2> offsets_m{{0.0, 0.0}};
  read_fields(value, {required({"object", [&](const YamlValue& name) { object = object_named(name, objects); }}),
                      required({"at", at_m}),
                      {"yaw", kAngle, yaw_rad},
                      repeat_field(parts, offsets_m)});
  const Pose2 T_map_object{at_m.x(), at_m.y(), yaw_rad};
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

/// State shared by the readers of one scene.
struct SceneParts {
  PartCount count;
  sim::Wall wall_defaults;
  Objects objects;
  std::size_t triangles = 0;
};

}  // namespace

std::vector<YamlField> scene_part_fields(sim::Scene& scene) {
  const auto parts = std::make_shared<SceneParts>();
  const auto read_mesh_entry = [parts, &scene](const YamlValue& mesh) {
    parts->count.add(mesh, 1);
    scene.meshes.push_back(read_placed_mesh(mesh, sim::kMaxTriangles - parts->triangles));
    parts->triangles += scene.meshes.back().triangles.size();
  };
  return {
      {"wall_defaults",
       [parts](const YamlValue& sizes) { read_fields(sizes, wall_size_fields(parts->wall_defaults)); }},
      list_field("walls",
                 [parts, &scene](const YamlValue& wall) {
                   scene.walls.push_back(read_wall(wall, parts->wall_defaults, parts->count));
                 }),
      boxes_field(parts->count, scene),
      cylinders_field(parts->count, scene),
      list_field("objects", [parts](const YamlValue& object) { read_object(object, parts->count, parts->objects); }),
      list_field("place",
                 [parts, &scene](const YamlValue& place) { read_place(place, parts->objects, parts->count, scene); }),
      list_field("meshes", read_mesh_entry),
      floor_field("ramps", parts->count, scene, read_ramp),
      floor_field("plates", parts->count, scene, read_plate),
      floor_field("sills", parts->count, scene, read_sill),
      {"floor", [&scene](const YamlValue& floor) { scene.floor_m = floor.number(kLength); }},
      {"ceiling", [&scene](const YamlValue& ceiling) { scene.ceiling_m = ceiling.number(kLength); }}};
}

}  // namespace gdtslam
