// What a record of a fleet's unit may hold: each value at its bound and beside it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/record.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using RecordJson = nlohmann::ordered_json;

UnitRecord sound_record() {
  UnitRecord record;
  record.plan = "0123456789abcdef";
  record.unit = 7;
  record.uri = "/logs/a.log";
  record.input_sha256 = std::string(64, 'a');
  record.run = std::string(16, '9');
  record.result_sha256 = std::string(64, 'f');
  return record;
}

/// What is said of a record so changed; empty where it is taken.
std::string fault_after(const std::function<void(UnitRecord&)>& change) {
  UnitRecord record = sound_record();
  change(record);
  try {
    static_cast<void>(parse_record(record_text(record), "r.json"));
  } catch (const InputError& error) {
    EXPECT_EQ(parse_records_table(records_table(record.plan, {record}), record.plan), std::nullopt);
    return error.what();
  }
  EXPECT_TRUE(parse_records_table(records_table(record.plan, {record}), record.plan));
  return "";
}

TEST(FleetRecordRules, HashesHaveTheirDigits) {
  EXPECT_EQ(fault_after([](UnitRecord&) {}), "");
  using Member = std::string UnitRecord::*;
  const std::vector<std::pair<Member, std::size_t>> rows{
      {&UnitRecord::run, 16}, {&UnitRecord::input_sha256, 64}, {&UnitRecord::result_sha256, 64}};
  for (const auto& [member, digits] : rows) {
    for (const std::string& wrong : {std::string(digits - 1, 'a'), std::string(digits + 1, 'a'), std::string(),
                                     std::string(digits - 1, 'a') + "A", "g" + std::string(digits - 1, '0')}) {
      EXPECT_THAT(fault_after([&, changed = member](UnitRecord& r) { r.*changed = wrong; }),
                  HasSubstr("that is none; running its shard again"));
    }
  }
  EXPECT_THROW(static_cast<void>(parse_record(record_text([] {
                                                UnitRecord record = sound_record();
                                                record.plan.pop_back();
                                                return record;
                                              }()),
                                              "r.json")),
               InputError);
}

TEST(FleetRecordRules, ARefusedOneHasNoResult) {
  EXPECT_THAT(fault_after([](UnitRecord& r) { r.exit_code = 65; }), HasSubstr("result_sha256"));
  const auto refuse = [](int exit_code) {
    return fault_after([=](UnitRecord& r) {
      r.exit_code = exit_code;
      r.result_sha256.clear();
    });
  };
  EXPECT_EQ(refuse(1), "");
  EXPECT_EQ(refuse(255), "");
  EXPECT_THAT(refuse(256), HasSubstr("a number that is none"));
  EXPECT_NE(refuse(-1), "");
}

TEST(FleetRecordRules, NumbersAreWithinTheirBounds) {
  EXPECT_EQ(fault_after([](UnitRecord& r) { r.unit = kMostUnits - 1; }), "");
  EXPECT_THAT(fault_after([](UnitRecord& r) { r.unit = kMostUnits; }), HasSubstr("a number that is none"));
  EXPECT_EQ(kMostUnits, 500'000U);
  const double endless = std::numeric_limits<double>::infinity();
  using Change = std::function<void(UnitRecord&, double)>;
  const std::vector<Change> changes{[](UnitRecord& r, double v) { r.figures.path_m = v; },
                                    [](UnitRecord& r, double v) { r.figures.log_duration_s = v; },
                                    [](UnitRecord& r, double v) { r.figures.width_m = v; },
                                    [](UnitRecord& r, double v) { r.figures.height_m = v; },
                                    [](UnitRecord& r, double v) { r.cpu_s = v; },
                                    [](UnitRecord& r, double v) { r.wall_s = v; }};
  for (const Change& change : changes) {
    UnitRecord record = sound_record();
    change(record, endless);
    EXPECT_EQ(parse_records_table(records_table(record.plan, {record}), record.plan), std::nullopt);
    change(record, -1.5);
    EXPECT_TRUE(parse_records_table(records_table(record.plan, {record}), record.plan));
  }
}

TEST(FleetRecordRules, EachKeyIsThereAndOfItsKind) {
  const RecordJson whole = RecordJson::parse(record_text(sound_record()));
  const auto is_refused = [](const RecordJson& json) {
    try {
      static_cast<void>(parse_record(json.dump(), "r.json"));
      return false;
    } catch (const InputError&) {
      return true;
    }
  };
  EXPECT_FALSE(is_refused(whole));
  EXPECT_EQ(whole.size(), 23U);
  for (const auto& [key, value] : whole.items()) {
    RecordJson changed = whole;
    changed[key] = RecordJson::array();
    EXPECT_TRUE(is_refused(changed) || key == "outcome") << key;
    changed.erase(key);
    EXPECT_TRUE(is_refused(changed) || key == "outcome") << key;
  }
  for (const char* count : {"unit", "bytes", "exit_code", "scans", "doubtful", "keyframes"}) {
    for (const RecordJson& wrong : {RecordJson(-1), RecordJson(1.5), RecordJson("1")}) {
      RecordJson changed = whole;
      changed[count] = wrong;
      EXPECT_TRUE(is_refused(changed)) << count << wrong;
    }
  }
}

TEST(FleetRecordRules, PathsHaveAThousandUnitsAFolder) {
  EXPECT_EQ(record_path(0), "units/000/000000.json");
  EXPECT_EQ(record_path(999), "units/000/000999.json");
  EXPECT_EQ(record_path(1000), "units/001/001000.json");
  EXPECT_EQ(record_path(499'999), "units/499/499999.json");
  EXPECT_EQ(run_path("abcdef0123456789"), "runs/ab/abcdef0123456789");
}

TEST(FleetRecordRules, ControlCharactersAreBlanks) {
  EXPECT_EQ(table_text(std::string("a\0b\x1F\x20\x7E\x7F\x80\t\nz", 11)), std::string("a b \x20\x7E \x80  z"));
}

// A column more or less, a number with something behind it, a wrong count at the end.
TEST(FleetRecordRules, ATableIsTakenAsAWholeOrNotAtAll) {
  const std::string plan = sound_record().plan;
  const std::string text = records_table(plan, {sound_record(), sound_record()});
  ASSERT_EQ(parse_records_table(text, plan)->size(), 2U);
  EXPECT_EQ(parse_records_table(text, plan)->front(), sound_record());
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return parse_records_table(other, plan);
  };
  EXPECT_FALSE(changed("/logs/a.log\n", "/logs/a.log\tmore\n"));
  EXPECT_FALSE(changed("\t/logs/a.log\n", "\n"));
  EXPECT_FALSE(changed("\n7\t", "\n7x\t"));
  EXPECT_FALSE(changed("\n7\t", "\n\t"));
  EXPECT_FALSE(changed("# 2 records", "# 3 records"));
  EXPECT_FALSE(changed("# 2 records\n", "# 2 records\nmore"));
  EXPECT_FALSE(parse_records_table(text, "fedcba9876543210"));
  EXPECT_TRUE(parse_records_table(records_table(plan, {}), plan)->empty());
}

}  // namespace
}  // namespace gdtslam
