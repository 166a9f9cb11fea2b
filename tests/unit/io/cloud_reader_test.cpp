// Clouds from other programs, damaged ones and hostile ones; each has one stated outcome.
#include <gmock/gmock.h>

#include <string>

#include "engine/io/clouds/cloud_file_layout.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "io_test_support.hpp"
#include "support/lzf_packer.hpp"

namespace gdtslam {
namespace {

using namespace std::string_literals;
using ::testing::HasSubstr;

constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";

std::string ply(const std::string& count, const std::string& body, const std::string& columns = kXyz) {
  return "ply\nformat ascii 1.0\nelement vertex " + count + "\n" + columns + "end_header\n" + body;
}

std::string pcd(const std::string& points, const std::string& data, const std::string& body) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + points +
         "\nHEIGHT 1\nPOINTS " + points + "\nDATA " + data + "\n" + body;
}

Cloud read(const std::string& file) {
  CloudReader reader(bytes_of(file), "c");
  Cloud cloud;
  for (Cloud piece = reader.next(); !piece.empty(); piece = reader.next()) {
    cloud.insert(cloud.end(), piece.begin(), piece.end());
  }
  return cloud;
}

std::string cloud_error(const std::string& file) {
  return told_by<InputError>([&] { read(file); }, "no error");
}

std::string word(std::uint32_t value) {
  std::string text;
  for (int k = 0; k < 4; ++k) text += static_cast<char>(value >> (8 * k) & 255U);
  return text;
}

TEST(CloudReader, OldPcdWithoutSizesIsOfFloats) {
  EXPECT_EQ(read("# .PCD v.5\nVERSION .5\nCOLUMNS x y z\nPOINTS 1\nDATA ascii\n1 2 -3.5\n"),
            (Cloud{{.x_m = 1.0F, .y_m = 2.0F, .z_m = -3.5F}}));
}

TEST(CloudReader, BlankLinesAndSpacesAreNothing) { EXPECT_EQ(read(ply("2", "\n 1\t2 3 \n\n4 5 6")).size(), 2U); }

TEST(CloudReader, PointsThatAreNotFiniteAreSkippedAndCounted) {
  const std::string file = ply("5", "1 2 3\nnan 2 3\n1 inf 3\n1 2 1e39\n4 5 6\n");
  CloudReader reader(bytes_of(file), "c");
  EXPECT_EQ(reader.next(1).size(), 1U);
  EXPECT_EQ(reader.next(1).front().x_m, 4.0F);
  EXPECT_TRUE(reader.next(1).empty());
  EXPECT_EQ(reader.skipped(), 3U);
  EXPECT_TRUE(read(ply("1", "1 2 3 nan\n", std::string(kXyz) + "property double time\n")).empty());
  EXPECT_TRUE(read(ply("1", "nan 2 3 nan\n", std::string(kXyz) + "property float scan\n")).empty());
}

TEST(CloudReader, CloudsInACountrysGridKeepTheirMillimetres) {
  const std::string far = ply("3", "500000.123 5400000.456 -3.5\n500001.124 5400000.457 2\n499999 5399998.001 0\n",
                              "property double x\nproperty double y\nproperty double z\n");
  CloudReader reader(bytes_of(far), "c");
  reader.make_relative();
  const Cloud cloud = reader.next();
  ASSERT_EQ(cloud.size(), 3U);
  EXPECT_EQ(reader.origin_m(), (std::array<double, 3>{500000.0, 5400000.0, 0.0}));
  EXPECT_NEAR(cloud[1].x_m - cloud[0].x_m, 1.001, 1e-6);
  EXPECT_NEAR(cloud[1].y_m - cloud[0].y_m, 0.001, 1e-6);
  EXPECT_NEAR(cloud[2].y_m, -1.999, 1e-6);
  EXPECT_EQ(cloud[0].z_m, -3.5F);
}

TEST(CloudReader, MemoryAndFilesMayBeGzip) {
  const TemporaryFolder folder;
  const std::string packed = gzip(ply("1", "1 2 3\n"));
  put_file(folder / "c.ply.gz", packed);
  EXPECT_EQ(read_cloud(folder / "c.ply.gz").size(), 1U);
  EXPECT_EQ(read(packed).size(), 1U);
  std::string points;
  for (std::uint32_t k = 0; k < 60000; ++k) points += word(k * 2654435761U & 0x3fffffffU);
  const std::string whole = gzip(pcd("20000", "binary", points));
  EXPECT_EQ(read(whole).size(), 20000U);
  EXPECT_THAT(cloud_error(whole.substr(0, whole.size() / 2)), HasSubstr("the gzip stream stops early"));
}

TEST(CloudReader, MoreThanAllowedSaysWhatToDo) {
  const TemporaryFolder folder;
  put_file(folder / "c.ply", ply("3", "1 2 3\n1 2 3\n1 2 3\n"));
  EXPECT_EQ(read_cloud(folder / "c.ply", 3).size(), 3U);
  try {
    read_cloud(folder / "c.ply", 2);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("c.ply: has more than 2 points; thin it"));
  }
}

TEST(CloudReader, EachFaultHasItsLine) {
  const auto at = [](const std::string& file, const std::string& message) {
    EXPECT_THAT(cloud_error(file), HasSubstr(message)) << file;
  };
  at("", "c: is empty");
  at("solid stl\n", "c:1: is neither PLY nor PCD");
  at("ply\nelement vertex 0\nend_header\n", "c:3: the header has no 'format' line");
  at("ply\nformat ascii 1.0\nelement vertex 1\n", "no 'end_header'");
  at("ply\nformat ebcdic 1.0\n", "c:2: \"ebcdic\" is no format of PLY");
  at("ply\nformat ascii 1.0\nelement vertex -1\n", "c:3: expected 'element NAME COUNT'");
  at("ply\nformat ascii 1.0\nproperty float x\n", "c:3: a property before the first element");
  at("ply\nformat ascii 1.0\nelement face 0\nend_header\n", "has no element 'vertex'");
  at("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", "c:4: \"half\" is no type of PLY");
  at("ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n", "the length of a list is a whole number");
  at("ply\nformat ascii 1.0\n\x1b[31mred 1\n", "c:3: \"?[31mred\" is no keyword");
  at(ply("1", "1 2\n", "property float x\nproperty float y\n"), "no column 'z'");
  at(ply("1", "1 2 3\n", "property float y\nproperty float z\nproperty list uchar float x\n"), "no column 'x'");
  at(ply("1", "1 1 2 3\n", std::string("property int x\n") + kXyz), "two columns 'x'");
  at(ply("2", "1 2 3\n"), "c: ends after 1 of the 2 points");
  at(ply("1", "1 2\n"), "c:8: has fewer numbers");
  at(ply("1", "1 2 3 4\n"), "c:8: has more numbers");
  at(ply("1", "1 2 3x\n"), "c:8: has fewer numbers than columns, or a word among them");
  at(ply("1", "1 2 3\n4 5 6\n"), "c:9: goes on after the 1 points");
  at(ply("1", "1 2 3 -1\n", std::string(kXyz) + "property int scan\n"), "scan number");
  at(ply("1", "1 2 3 -1 4\n", std::string(kXyz) + "property list int int n\n"), "the length of a list");
  at(pcd("2", "binary", std::string(12, '\0')), "c: ends after 1 of the 2 points");
  at(pcd("2", "binary", std::string(23, '\0')), "c: ends after 1 of the 2 points");
  at(pcd("2", "binary", std::string(36, '\0')), "c: goes on after the 2 points");
  at(pcd("1", "zip", ""), "DATA is \"zip\"");
  at(pcd("one", "ascii", ""), "c:7: WIDTH needs one whole number");
  at("# .PCD\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n", "different lengths");
  at("# .PCD\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F Q\nWIDTH 1\nDATA ascii\n", "TYPE \"Q\" with SIZE \"4\"");
  at("# .PCD\nFIELDS x y z\nWIDTH 2\nHEIGHT 2\nPOINTS 5\nDATA ascii\n", "POINTS is 5, WIDTH times HEIGHT 4");
  at("# .PCD\nFIELDS x y z\nDATA ascii\n", "neither POINTS nor WIDTH");
  at("# .PCD\nFIELDS x y z\nCOUNT 1 1 3\nWIDTH 1\nDATA ascii\n1 2 3 4 5\n", "no column 'z' of one number");
  at("# .PCD\nPRICE 3\n", "c:2: \"PRICE\" is no keyword of a PCD header");
  at("# .PCD\nFIELDS x y z\n", "no DATA line");
  at(ply("1", std::string(70000, '1') + " 2 3\n"), "c:8: the line is longer than 64 KiB");
}

TEST(CloudReader, CompressedDataMustFitTheirHeader) {
  const std::string packed = test::pack_lzf(std::string(24, '\0'));
  const auto body = [&](std::uint32_t packed_size, std::uint32_t size) {
    return pcd("2", "binary_compressed", word(packed_size) + word(size) + packed);
  };
  const auto size = static_cast<std::uint32_t>(packed.size());
  EXPECT_EQ(read(body(size, 24)).size(), 2U);
  EXPECT_THAT(cloud_error(body(size, 25)), HasSubstr("do not fit its header"));
  EXPECT_THAT(cloud_error(body(0xffffffffU, 24)), HasSubstr("do not fit its header"));
  EXPECT_THAT(cloud_error(body(size + 1, 24)), HasSubstr("ends within its compressed data"));
  EXPECT_THAT(cloud_error(body(size - 1, 24)), HasSubstr("damaged"));
  EXPECT_THAT(cloud_error(pcd("1", "binary_compressed", word(2) + word(12) + "\xff\xff")), HasSubstr("damaged"));
  EXPECT_TRUE(read(pcd("0", "binary_compressed", "")).empty());
}

// Numbers that no file can back: each ends at once, with little memory.
TEST(CloudReader, HostileHeadersTakeNeitherTimeNorMemory) {
  const std::string huge = "1000000000000000000";
  const std::string binary = "ply\nformat binary_little_endian 1.0\n";
  const std::string many(1000 * 2, '1');
  std::string fields = "FIELDS x y z";
  std::string counts = "COUNT 1 1 1";
  for (int k = 0; k < 900; ++k) {
    fields += " a";
    counts += " 8000";
  }
  const std::vector<std::string> files{
      ply(huge, "1 2 3\n"),
      binary + "element vertex " + huge + "\n" + kXyz + "end_header\n1234",
      binary + "element vertex 0\n" + kXyz + "element face " + huge + "\nend_header\n",
      binary + "element nothing 18446744073709551615\nelement vertex 1\n" + kXyz + "end_header\n",
      binary + "element face " + huge + "\nproperty list uint double v\nelement vertex 1\n" + kXyz +
          "end_header\n\xff\xff\xff\xff",
      ply("1", "1e300 1 2 3\n", std::string("property list uint int v\n") + kXyz),
      pcd(huge, "ascii", "1 2 3\n"),
      pcd(huge, "binary", "123"),
      pcd(huge, "binary_compressed", word(100) + word(1200)),
      pcd("1431655765", "binary_compressed", word(1U << 30U) + word(0xfffffffcU)),
      pcd("3074457345618258603", "binary_compressed", word(1) + word(4)),
      "# .PCD\nFIELDS x y z\nWIDTH 4294967296\nHEIGHT 4294967296\nDATA binary\n",
      "# .PCD\n" + fields + "\n" + counts + "\nWIDTH " + huge + "\nDATA binary\n",
      "# .PCD\n" + fields + "\n" + counts + "\nWIDTH 1\nDATA ascii\n1 2 3\n",
      "# .PCD\nFIELDS x y z\nCOUNT 1 1 8001\nWIDTH 1\nDATA ascii\n",
      "# .PCD\nFIELDS " + many + "\n",
  };
  for (const std::string& file : files) {
    SCOPED_TRACE(file.substr(0, 200));
    const BoundedRun run = run_alone([&] {
      try {
        return read(file).empty() ? 0 : 1;
      } catch (const InputError&) {
        return 65;
      }
    });
    expect_bounded(run);
    EXPECT_TRUE(run.code == 65 || file.find("element vertex 0\n") != std::string::npos) << run.code;
  }
}

// A byte below 32: so many bytes and one more follow as they are. Else its upper three bits are two less than the
// number of bytes to repeat (7: the next byte is added), and its lower five with the next byte one less than how far
// back.
TEST(Lzf, CopiesAndRepeats) {
  EXPECT_EQ(unpack_lzf("\0a"s, 1), "a");
  EXPECT_EQ(unpack_lzf("\2abc", 3), "abc");
  EXPECT_EQ(unpack_lzf("\x1f" + std::string(32, 'q'), 32), std::string(32, 'q'));
  EXPECT_EQ(unpack_lzf("\2abc\x20\2"s, 6), "abcabc") << "three from three back";
  EXPECT_EQ(unpack_lzf("\2abc\x20\0"s, 6), "abcccc") << "three from one back";
  EXPECT_EQ(unpack_lzf("\2abc\xc0\1"s, 11), "abcbcbcbcbc") << "eight from two back";
  EXPECT_EQ(unpack_lzf("\0a\xe0\0\0"s, 10), std::string(10, 'a')) << "nine";
  EXPECT_EQ(unpack_lzf("\0a\xe0\xff\0"s, 265), std::string(265, 'a')) << "264, the most";
  std::string far;
  for (int k = 0; k < 10; ++k) far += "\x1f"s + std::string(32, 'x');
  far[1] = 'F';
  EXPECT_EQ(unpack_lzf(far + "\x21\x3f"s, 323).value().substr(320), "Fxx") << "from 320 back";
}

}  // namespace
}  // namespace gdtslam
