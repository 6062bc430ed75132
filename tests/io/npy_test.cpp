#include "taut/io/npy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "io/temporary_folder.h"
#include "taut/base/error.h"

namespace taut::test {
namespace {

// A file as numpy 1.x writes numpy.array([[1, 2, 3], [4, 5, 6.5]], "<f4"): byte by byte from the
// format's description.
std::string numpy_file() {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
  header.append(128 - 10 - header.size() - 1, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00\x76\x00", 10);
  bytes += header;
  bytes += std::string(
      "\x00\x00\x80\x3f\x00\x00\x00\x40\x00\x00\x40\x40\x00\x00\x80\x40\x00\x00\xa0\x40\x00\x00\xd0"
      "\x40",
      24);
  return bytes;
}

template <class T>
std::string refusal(std::string_view bytes) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.file("a.npy", bytes);
  try {
    read_npy<T>(path);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.rfind(path.string() + ": ", 0), 0u) << message;
    return message.substr(path.string().size() + 2);
  }
  return "read";
}

TEST(Npy, ReadsAndWritesTheBytesOfNumpy) {
  const TemporaryFolder folder;
  const NpyArray<float> array = read_npy<float>(folder.file("a.npy", numpy_file()));
  EXPECT_EQ(array.shape, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(array.values, (std::vector<float>{1, 2, 3, 4, 5, 6.5}));
  write_npy<float>(folder / "b.npy", array.values, array.shape);
  EXPECT_EQ(read_file(folder / "b.npy"), numpy_file());
}

template <class T>
void round_trip(const std::vector<T>& values, const std::vector<std::int64_t>& shape) {
  const TemporaryFolder folder;
  write_npy<T>(folder / "a.npy", values, shape);
  const NpyArray<T> back = read_npy<T>(folder / "a.npy");
  EXPECT_EQ(back.values, values);
  EXPECT_EQ(back.shape, shape);
  EXPECT_EQ((read_file(folder / "a.npy").size() - values.size() * sizeof(T)) % 64, 0u);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Npy, RoundTripOfEveryTypeAndShape) {
  round_trip<double>({1.0 / 3, -1e300, 5e-324, 0}, {4});
  round_trip<double>({1, 2, 3, 4, 5, 6, 7, 8}, {2, 2, 2});
  round_trip<float>({0.1f}, {});
  round_trip<std::int32_t>({-2147483647 - 1, 2147483647}, {2, 1});
  round_trip<std::int32_t>({}, {0, 3});
  round_trip<float>(std::vector<float>(100, 1.5f),
                    {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 100});
}

TEST(Npy, NodesKeepTheirBits) {
  std::vector<Vec3> nodes;
  for (int i = 0; i < 7; ++i) nodes.emplace_back(std::sin(i), 1.0 / (i + 1), -i);
  const TemporaryFolder folder;
  write_npy(folder / "x.npy", nodes);
  EXPECT_EQ(read_npy_nodes(folder / "x.npy"), nodes);
  write_npy_float(folder / "f.npy", nodes);
  const std::vector<Vec3> rounded = read_npy_nodes(folder / "f.npy");
  ASSERT_EQ(rounded.size(), nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    EXPECT_EQ(rounded[i], nodes[i].cast<float>().cast<double>());
  write_npy<double>(folder / "y.npy", std::vector<double>(4), std::vector<std::int64_t>{2, 2});
  EXPECT_THROW(read_npy_nodes(folder / "y.npy"), InputError);
}

TEST(Npy, RefusalsSayWhatIsWrong) {
  const std::string good = numpy_file();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  EXPECT_EQ(refusal<float>(good), "read");
  EXPECT_EQ(refusal<double>(good).rfind("holds numbers of type '<f4', '<f8' was expected", 0), 0u);
  EXPECT_EQ(refusal<float>(with("<f4", ">f4")).rfind("holds numbers of type '>f4'", 0), 0u);
  EXPECT_EQ(refusal<float>(with("False, ", "True,  ")).rfind("is in Fortran order", 0), 0u);
  EXPECT_EQ(refusal<float>(with("(2, 3)", "(2, 4)"))
                .rfind("has 24 bytes of data, which is not 2 x 4 numbers of 4 bytes", 0),
            0u);
  EXPECT_EQ(refusal<float>(with("(2, 3), }              ", "(4294967296,4294967296)"))
                .rfind("the .npy header lacks '}'", 0),
            0u);
  EXPECT_EQ(refusal<float>(with("(2, 3), }                 ", "(4294967296,4294967296), }"))
                .rfind("has 24 bytes of data, which is not", 0),
            0u);
  EXPECT_EQ(refusal<float>(with("(2, 3)", "(-2,3)")).rfind("the .npy header has a shape with", 0),
            0u);
  EXPECT_EQ(refusal<float>(with("'shape'", "'shapo'"))
                .rfind("the .npy header has an unknown key 'shapo'", 0),
            0u);
  EXPECT_EQ(refusal<float>("PK\x03\x04 an .npz archive").rfind("is not a .npy file", 0), 0u);
  EXPECT_EQ(refusal<float>(with(std::string("\x01\x00", 2), std::string("\x09\x00", 2)))
                .rfind("has .npy version 9", 0),
            0u);
}

TEST(Npy, CutAnywhereItIsRefused) {
  const std::string good = numpy_file();
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_NE(refusal<float>(good.substr(0, length)), "read") << length;
  EXPECT_NE(refusal<float>(good + "x"), "read");
}

// The first Python that has NumPy: where another one stands before Debian's, that has it.
std::string python_with_numpy() {
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (std::system((std::string(python) + " -c 'import numpy' 2>/dev/null").c_str()) == 0)
      return python;
  return {};
}

TEST(Npy, NumpyItselfAgrees) {
  const std::string python = python_with_numpy();
  if (python.empty()) GTEST_SKIP() << "python3 with numpy is not installed";
  const TemporaryFolder folder;
  write_npy(folder / "x.npy", std::vector<Vec3>{{1, 2, 3}, {4, 5, 6.5}});
  const std::string command = python + " -c 'import numpy, sys; a = numpy.load(\"" +
                              (folder / "x.npy").string() +
                              "\"); assert a.shape == (2, 3) and a.dtype == numpy.float64 and a[1, "
                              "2] == 6.5; numpy.save(\"" +
                              (folder / "y.npy").string() + "\", a * 2)'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_npy_nodes(folder / "y.npy"), (std::vector<Vec3>{{2, 4, 6}, {8, 10, 13}}));
}

}  // namespace
}  // namespace taut::test
