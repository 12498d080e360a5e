#include "Applications/RunReport.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "Applications/Version.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

TEST(RunReport, HoldsTheCommonFields) {
  const testing::TemporaryFolder folder;
  RunReport report("register", 2);
  report.add_input("fixed", folder.write("abc", "abc"));
  report.add_warning("folds");
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  report.add_part("alignment", 0.015);
  report.end_stage("optimization");
  const auto json = nlohmann::json::parse(report.to_json("ok", {{"triangles", 72}}));
  EXPECT_EQ(json["version"], version_number());
  EXPECT_EQ(json["command"], "register");
  EXPECT_EQ(json["format_version"], 1);
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["inputs"][0]["option"], "fixed");
  EXPECT_EQ(json["inputs"][0]["sha256"],
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(json["warnings"], nlohmann::json::array({"folds"}));
  EXPECT_EQ(json["threads"], 2);
  EXPECT_EQ(json["triangles"], 72);
  EXPECT_GT(json["peak_memory_mb"], 1.0);
  const auto& timings = json["timings_s"];
  EXPECT_EQ(timings["alignment"], 0.015);
  EXPECT_GE(timings["optimization"], 0.004);  // 20 ms without the 15 of its part
  EXPECT_GE(timings["total"], 0.020);
  // Millisecond rounding aside, the stages make up the total.
  EXPECT_NEAR(timings["total"].get<double>(), 0.015 + timings["optimization"].get<double>(), 0.01);
}

TEST(RunReport, NoWarningsAreAnEmptyList) {
  const RunReport report("info", 1);
  EXPECT_EQ(nlohmann::json::parse(report.to_json("ok", nlohmann::json::object()))["warnings"],
            nlohmann::json::array());
}

}  // namespace
}  // namespace crease
