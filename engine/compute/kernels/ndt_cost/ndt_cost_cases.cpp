#include <array>
#include <cmath>
#include <limits>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/cases/scan_data.hpp"
#include "engine/core/elementary.hpp"
#include "ndt_cost.hpp"

namespace gdtslam {
namespace {

/// The points of a case lie anywhere in and around the box, on the borders of its cubes, at the means, or near them in
/// thin planes: there large terms of a distance cancel, and a changed rounding of one crosses a step. Odd cases have
/// points and poses that are not finite or far away, too.
enum class NdtPlace : std::uint8_t { kAnywhere, kBorders, kMeans, kPlanes, kOdd };
constexpr NdtPlace kNdtPlaces[] = {NdtPlace::kAnywhere, NdtPlace::kBorders, NdtPlace::kMeans, NdtPlace::kPlanes,
                                   NdtPlace::kOdd};
constexpr const char* kNdtPlaceNames[] = {"", " borders", " means", " planes", " odd"};

struct NdtSize {
  std::uint32_t x, y, z;
};

struct NdtCase {
  using Kernel = NdtCost;
  NdtSize box;
  std::uint32_t points = 0;
  std::uint32_t poses = 0;
  NdtPlace place = NdtPlace::kAnywhere;
  double share = 0.6;  ///< of the cubes, with a distribution
  float cubes_per_m = 1.0F;
  float steps_per_unit = 8.0F;
  double origin_m = 0.0;  ///< of the box, along each axis more
  double turn_rad = 3.0;  ///< largest angle of a pose
  bool has_any_table = false;
  bool is_round = false;  ///< whole numbers for means and information, so that distances lie between two steps

  [[nodiscard]] std::string name() const {
    return std::to_string(box.x) + "x" + std::to_string(box.y) + "x" + std::to_string(box.z) + " " +
           std::to_string(poses) + " poses " + std::to_string(points) + " points" +
           kNdtPlaceNames[static_cast<std::size_t>(place)] + (has_any_table ? " any table" : "") +
           (is_round ? " round" : "");
  }
  [[nodiscard]] double edge_m() const { return 1.0 / static_cast<double>(cubes_per_m); }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

/// A table like that of a search, or any.
std::array<std::uint32_t, NdtCost::kSteps> ndt_table(bool any, Random& random) {
  std::array<std::uint32_t, NdtCost::kSteps> table{};
  for (std::uint32_t i = 0; i + 1 < NdtCost::kSteps; ++i) {
    const double like_a_search = std::floor(1000.0 * exp(-(i + 0.5) / 48.0) + 0.5);
    table[i] = any ? static_cast<std::uint32_t>(random.below(NdtCost::kMostScore + 1))
                   : static_cast<std::uint32_t>(like_a_search);
  }
  return table;
}

/// A distribution in a cube: a product of a matrix with itself, so that no distance is below 0.
NdtCost::Distribution ndt_normal(const NdtCase& drawn, NdtSize cube, Random& random) {
  if (drawn.is_round) {
    return {.mean_x = static_cast<float>(cube.x + 1),
            .mean_y = static_cast<float>(cube.y),
            .mean_z = static_cast<float>(cube.z),
            .xx = 1.0F,
            .yy = 2.0F,
            .zz = 3.0F};
  }
  const auto mean = [&](std::uint32_t i) { return static_cast<float>((i + random.uniform()) * drawn.edge_m()); };
  double root[3][3];
  for (auto& row : root) {
    const double thin = drawn.place == NdtPlace::kPlanes && &row == &root[0] ? 300.0 : 1.0;
    for (double& value : row) value = thin * random.uniform(-4.0, 4.0) / drawn.edge_m();
  }
  const auto product = [&root](std::size_t i, std::size_t j) {
    return static_cast<float>(root[0][i] * root[0][j] + root[1][i] * root[1][j] + root[2][i] * root[2][j]);
  };
  return {mean(cube.x),  mean(cube.y),  mean(cube.z),  product(0, 0), product(0, 1),
          product(0, 2), product(1, 1), product(1, 2), product(2, 2)};
}

struct NdtScene {
  std::vector<NdtCost::Distribution> normals = {};
  std::vector<std::int32_t> cubes = {};
};

/// Cubes without a distribution, with their own, with another one's, and in odd cases with a number of none.
NdtScene ndt_scene(const NdtCase& drawn, Random& random) {
  constexpr std::int32_t kNoNumbers[] = {NdtCost::kNone, -2, std::numeric_limits<std::int32_t>::max(),
                                         std::numeric_limits<std::int32_t>::min()};
  NdtScene scene;
  for (std::uint32_t z = 0; z < drawn.box.z; ++z) {
    for (std::uint32_t y = 0; y < drawn.box.y; ++y) {
      for (std::uint32_t x = 0; x < drawn.box.x; ++x) {
        const std::size_t known = scene.normals.size();
        const bool is_new = random.uniform() < drawn.share;
        if (is_new) scene.normals.push_back(ndt_normal(drawn, {x, y, z}, random));
        const bool is_other = known > 0 && random.below(16) == 0;
        const std::int32_t none = drawn.place == NdtPlace::kOdd ? draw_from(random, kNoNumbers) : NdtCost::kNone;
        scene.cubes.push_back(is_other ? static_cast<std::int32_t>(random.below(known))
                                       : (is_new ? static_cast<std::int32_t>(known) : none));
      }
    }
  }
  if (drawn.place == NdtPlace::kOdd && !scene.cubes.empty()) {
    scene.cubes.back() = static_cast<std::int32_t>(scene.normals.size());  // the first number of none
  }
  return scene;
}

/// A turn about x, then y, then z. The middle of the cloud comes to the middle of the box, or a bit beside.
NdtCost::Pose ndt_pose(const NdtCase& drawn, Random& random) {
  const auto turn = [&] { return sin_cos(random.uniform(-drawn.turn_rad, drawn.turn_rad)); };
  const auto [sx, cx] = turn();
  const auto [sy, cy] = turn();
  const auto [sz, cz] = turn();
  const double rows[9] = {cz * cy,
                          cz * sy * sx - sz * cx,
                          cz * sy * cx + sz * sx,
                          sz * cy,
                          sz * sy * sx + cz * cx,
                          sz * sy * cx - cz * sx,
                          -sy,
                          cy * sx,
                          cy * cx};
  NdtCost::Pose pose;
  for (std::size_t i = 0; i < 9; ++i) pose.rotation[i] = static_cast<float>(rows[i]);
  const std::uint32_t sides[3] = {drawn.box.x, drawn.box.y, drawn.box.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const double middle_m = 0.5 * sides[i] * drawn.edge_m() + drawn.origin_m * static_cast<double>(i + 1);
    pose.translation_m[i] = static_cast<float>(middle_m + random.uniform(-0.3, 0.3) * drawn.edge_m());
  }
  return pose;
}

/// A pose about which those of a case lie: with a turn for thin planes, else without.
NdtCost::Pose ndt_home(const NdtCase& drawn, Random& random) {
  if (drawn.place == NdtPlace::kPlanes) return ndt_pose(drawn, random);
  NdtCost::Pose home;
  for (std::size_t i = 0; i < 3; ++i) {
    home.translation_m[i] = static_cast<float>(drawn.origin_m * static_cast<double>(i + 1));
  }
  return home;
}

/// The home pose, moved by whole cubes or not at all.
NdtCost::Pose ndt_step_pose(const NdtCase& drawn, NdtCost::Pose pose, Random& random) {
  if (random.below(2) == 0) return pose;
  for (float& translation_m : pose.translation_m) {
    translation_m += static_cast<float>((static_cast<double>(random.below(3)) - 1.0) * drawn.edge_m());
  }
  return pose;
}

std::vector<NdtCost::Pose> ndt_poses(const NdtCase& drawn, const NdtCost::Pose& home, Random& random) {
  std::vector<NdtCost::Pose> poses;
  for (std::uint32_t i = 0; i < drawn.poses; ++i) {
    const bool is_step = (drawn.place != NdtPlace::kAnywhere && drawn.place != NdtPlace::kOdd) || i % 16 == 3;
    poses.push_back(is_step ? ndt_step_pose(drawn, home, random) : ndt_pose(drawn, random));
    if (drawn.place != NdtPlace::kOdd) continue;
    if (i % 8 == 1) poses.back().translation_m[i % 3] = std::numeric_limits<float>::quiet_NaN();
    if (i % 8 == 5) poses.back().rotation[i % 9] = std::numeric_limits<float>::infinity();
  }
  return poses;
}

/// A point on the borders of cubes, one unit in the last place beside, or a subnormal beside.
NdtCost::Point ndt_border_point(const NdtCase& drawn, Random& random) {
  const auto border = [&](std::uint32_t side) {
    const auto at = static_cast<float>((static_cast<double>(random.below(side + 3)) - 1.0) * drawn.edge_m());
    const float beside[] = {at, std::nextafter(at, -1.0e9F), std::nextafter(at, 1.0e9F), at + 0.5F};
    return draw_from(random, beside);
  };
  return {border(drawn.box.x), border(drawn.box.y), border(drawn.box.z)};
}

/// A point that the home pose puts into a distribution's thin plane, across which the first row of its information is.
NdtCost::Point ndt_plane_point(const NdtCase& drawn, const NdtCost::Distribution& normal, const NdtCost::Pose& home,
                               Random& random) {
  const auto real = [](float value) { return static_cast<double>(value); };
  const double mean[3] = {real(normal.mean_x), real(normal.mean_y), real(normal.mean_z)};
  const double across[3] = {real(normal.xx), real(normal.xy), real(normal.xz)};
  const double any[3] = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
  const double length = std::sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
  const double share = random.uniform(0.0, 0.5) * drawn.edge_m() / length;
  double point[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    const double along = share * (across[j] * any[k] - across[k] * any[j]);
    const double shift = real(home.translation_m[i]) - drawn.origin_m * static_cast<double>(i + 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] += real(home.rotation[3 * i + axis]) * (mean[i] + along - shift);
    }
  }
  return {static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])};
}

NdtCost::Point ndt_odd_point(std::uint32_t number) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr NdtCost::Point kOdd[] = {{kNaN, 0.0F, 0.0F},        {0.0F, kNaN, 0.0F},        {0.0F, 0.0F, kNaN},
                                     {kInfinity, 0.0F, 0.0F},   {0.0F, -kInfinity, 0.0F},  {3.0e38F, 3.0e38F, 0.0F},
                                     {0.0F, 1.0e9F, 4.0e9F},    {-3.0e38F, 0.0F, 2.2e9F},  {kSubnormal, 0.0F, 0.0F},
                                     {0.0F, -kSubnormal, 0.0F}, {0.0F, 0.0F, -kSubnormal}, {4294967296.0F, 0.0F, 0.0F}};
  return kOdd[number % std::size(kOdd)];
}

NdtCost::Point ndt_point(const NdtCase& drawn, const NdtScene& scene, const NdtCost::Pose& home, std::uint32_t number,
                         Random& random) {
  if (drawn.place == NdtPlace::kOdd && number % 2 == 1) return ndt_odd_point(number / 2);
  if (drawn.place == NdtPlace::kBorders) return ndt_border_point(drawn, random);
  const bool is_by_normal = drawn.place == NdtPlace::kMeans || drawn.place == NdtPlace::kPlanes;
  if (is_by_normal && !scene.normals.empty()) {
    const NdtCost::Distribution& normal = scene.normals[number % scene.normals.size()];
    if (drawn.place == NdtPlace::kPlanes) return ndt_plane_point(drawn, normal, home, random);
    return {normal.mean_x, normal.mean_y, normal.mean_z};
  }
  const auto place = [&](std::uint32_t side) { return draw_real(random, 0.6 * side * drawn.edge_m()); };
  return {place(drawn.box.x), place(drawn.box.y), place(drawn.box.z)};
}

KernelCase NdtCase::make(const std::string& named) const {
  Random random(seed_from(named));
  const auto table = ndt_table(has_any_table, random);
  const NdtScene scene = ndt_scene(*this, random);
  const NdtCost::Pose home = ndt_home(*this, random);
  std::vector<NdtCost::Point> cloud;
  for (std::uint32_t i = 0; i < points; ++i) cloud.push_back(ndt_point(*this, scene, home, i, random));
  const NdtCost::Params params{.point_count = points,
                               .size_x = box.x,
                               .size_y = box.y,
                               .size_z = box.z,
                               .distribution_count = static_cast<std::uint32_t>(scene.normals.size()),
                               .origin_x_m = static_cast<float>(origin_m),
                               .origin_y_m = static_cast<float>(2.0 * origin_m),
                               .origin_z_m = static_cast<float>(3.0 * origin_m),
                               .cubes_per_m = cubes_per_m,
                               .steps_per_unit = steps_per_unit};
  return make_case<NdtCost>(named, params, {poses, 1, 1},
                            {list_buffer(make_ndt_map(table, scene.normals, scene.cubes)), words_buffer(cloud),
                             words_buffer(ndt_poses(*this, home, random)), noise_buffer(poses, random)});
}

// Numbers of points and poses around lanes, blocks and groups; boxes that are empty, one wide, prime, long and thin.
void add_ndt_sizes(std::vector<KernelCaseSource>& list) {
  for (const std::uint32_t points : {0U, 1U, 63U, 64U, 65U, 127U, 128U, 129U, 2101U}) {
    add_case(list, NdtCase{{5, 4, 3}, points, 7});
    add_case(list, NdtCase{{5, 4, 3}, points, 2, NdtPlace::kMeans});
  }
  for (const std::uint32_t poses : {0U, 1U, 31U, 211U}) add_case(list, NdtCase{{7, 5, 2}, 83, poses});
  for (const NdtSize& box : {NdtSize{0, 3, 3},
                             {3, 0, 3},
                             {3, 3, 0},
                             {1, 1, 1},
                             {1, 9, 5},
                             {9, 1, 5},
                             {9, 5, 1},
                             {2, 2, 2},
                             {13, 11, 7},
                             {1, 1, 211},
                             {211, 1, 1},
                             {1, 211, 1},
                             {16, 16, 16}}) {
    for (const NdtPlace place : kNdtPlaces) add_case(list, NdtCase{box, 150, 19, place});
  }
}

// Edges and origins that are no powers of 2, coarse and fine steps, all and no cubes filled, any table.
void add_ndt_scales(std::vector<KernelCaseSource>& list) {
  for (const NdtPlace place : kNdtPlaces) {
    for (const auto& [cubes_per_m, origin_m] : {std::pair(1.0F, 1.0), {0.5F, -64.0}, {3.0F, 7.3}, {0.3F, -1000.7}}) {
      for (const float steps : {8.0F, 0.37F, 100.0F}) {
        NdtCase drawn{{6, 7, 5}, 301, 33, place, 0.8, cubes_per_m, steps, origin_m};
        drawn.has_any_table = steps < 50.0F;
        add_case(list, drawn,
                 ", " + std::to_string(cubes_per_m) + " per m at " + std::to_string(origin_m) + " steps " +
                     std::to_string(steps));
      }
    }
  }
  for (const float steps : {1.0F, 2.0F, 255.0F}) {
    NdtCase drawn{{6, 4, 3}, 203, 9, NdtPlace::kBorders, 0.9, 1.0F, steps};
    drawn.has_any_table = drawn.is_round = true;
    add_case(list, drawn, ", steps " + std::to_string(steps));
  }
  add_case(list, NdtCase{{3, 4, 2}, 2999, 41, NdtPlace::kPlanes, 1.0});  // many chances of a changed rounding to show
  for (const double share : {0.0, 0.05, 1.0}) {
    NdtCase drawn{{8, 9, 4}, 257, 12, NdtPlace::kAnywhere, share};
    drawn.has_any_table = true;
    add_case(list, drawn, ", filled " + std::to_string(share));
  }
}

void add_ndt_costs(std::vector<KernelCaseSource>& list) {
  add_ndt_sizes(list);
  add_ndt_scales(list);
  add_case(list, NdtCase{{5, 4, 3}, 3, 65537});  // more groups than a row of them has
  NdtCase full{{4, 4, 4}, NdtCost::kMostPoints, 2, NdtPlace::kMeans, 1.0};
  add_case(list, full, ", all", CaseUse::kLarge);
  add_case(list, NdtCase{{64, 64, 32}, 20000, 500, NdtPlace::kAnywhere, 0.2}, CaseUse::kLarge);
  NdtCase search{{64, 64, 16}, 3000, 1024, NdtPlace::kAnywhere, 0.2};
  search.turn_rad = 0.1;
  add_case(list, search, CaseUse::kBenchmark);
}

KernelCase draw_ndt(const std::string& name, Random& random) {
  const auto side = [&random] { return draw_count(random, 12); };
  NdtCase drawn{{side(), side(), side()}, draw_count(random, 400), draw_count(random, 60)};
  drawn.place = draw_from(random, kNdtPlaces);
  drawn.share = random.uniform();
  drawn.cubes_per_m = static_cast<float>(random.below(2) == 0 ? random.uniform(0.1, 4.0) : 2.0);
  drawn.steps_per_unit = static_cast<float>(random.below(2) == 0 ? random.uniform(0.01, 100.0) : 8.0);
  drawn.origin_m = random.below(2) == 0 ? random.uniform(-100.0, 100.0) : 0.0;
  drawn.turn_rad = random.uniform(0.0, 3.2);
  drawn.has_any_table = random.below(2) == 0;
  return drawn.make(name);
}

}  // namespace

CaseGroup NdtCost::cases() { return {add_ndt_costs, {{&NdtCost::info(), draw_ndt}}}; }

}  // namespace gdtslam
