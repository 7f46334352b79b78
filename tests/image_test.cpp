// SPDX-License-Identifier: MIT
#include "output/image.hpp"

#include <OpenImageIO/imageio.h>

#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "error.hpp"
#include "output/error_picture.hpp"
#include "output/metrics.hpp"
#include "output/write_file.hpp"
#include "support.hpp"

namespace manylight {
namespace {

Image gradient(unsigned width, unsigned height) {
    Image image(width, height, {"R", "G", "B"});
    for (std::size_t i = 0; i < image.values.size(); ++i)
        image.values[i] = 0.01f * static_cast<float>(i);
    return image;
}

// While it lives, files grow no further than this, as on a full disk.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) {
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        (void)std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit before_{};
    void (*handler_)(int);
};

std::string contents(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST(image, exr_keeps_floats_layers_and_header) {
    const std::string path = test::temporary("a.exr");
    Image color = gradient(7, 5);
    color.values[0] = 1e30f;  // no half float
    Image depth(7, 5, {"depth.Z"});
    depth.values[3] = 42;
    write_exr(path, {color, depth}, {{"manylight:sampler", "power"}, {"manylight:spp", 3}});
    EXPECT_EQ(read_rgb(path).values, color.values);
    const auto in = OIIO::ImageInput::open(path);
    ASSERT_TRUE(in);
    EXPECT_EQ(in->spec().format, OIIO::TypeDesc::FLOAT);
    EXPECT_EQ(in->spec().nchannels, 4);
    const int channel = in->spec().channelindex("depth.Z");
    ASSERT_GE(channel, 0);
    std::vector<float> pixels(7 * 5 * 4);
    in->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, pixels.data());
    EXPECT_EQ(pixels[3 * 4 + channel], 42);
    EXPECT_EQ(in->spec().get_string_attribute("manylight:sampler"), "power");
    EXPECT_EQ(in->spec().get_int_attribute("manylight:spp"), 3);
}

// sRGB (IEC 61966-2-1): 0.5 is 188, and what is out of range is clipped.
TEST(image, png_is_srgb) {
    const std::string path = test::temporary("a.png");
    Image image(3, 1, {"R", "G", "B"});
    image.values = {0, 0.25f, 0.5f, -1, 7, 0.001f, 0.5f, 0.5f, 0.5f};
    write_png(path, image, 2, {});
    const auto in = OIIO::ImageInput::open(path);
    ASSERT_TRUE(in);
    std::vector<unsigned char> found(9);
    in->read_image(0, 0, 0, -1, OIIO::TypeDesc::UINT8, found.data());
    EXPECT_EQ(found, (std::vector<unsigned char>{0, 188, 255, 0, 255, 7, 255, 255, 255}));
    // Reading takes the codes back to linear values.
    EXPECT_NEAR(read_rgb(path).values[1], 0.5, 0.003);
    EXPECT_NEAR(read_rgb(path).values[5], 0.002, 0.0003);
}

// An older file is replaced whole or stays as it was, and nothing else is left behind.
TEST(image, failed_writes_leave_the_old_file) {
    namespace fs = std::filesystem;
    const fs::path folder = test::temporary("outputs");
    fs::create_directories(folder);
    const std::string path = (folder / "a.exr").string();
    write_exr(path, {gradient(4, 4)}, {});
    const std::string before = contents(path);
    write_exr(path, {gradient(5, 5)}, {});
    EXPECT_NE(contents(path), before);
    const std::string whole = contents(path);
    EXPECT_THROW(
        {
            const FileSizeLimit limit(1000);
            write_exr(path, {gradient(50, 50)}, {});
        },
        RuntimeError);
    EXPECT_EQ(contents(path), whole);
    fs::create_directories(folder / "b.exr");  // in the way of the rename
    EXPECT_THROW(write_exr((folder / "b.exr").string(), {gradient(4, 4)}, {}), RuntimeError);
    EXPECT_THROW(write_exr((folder / "none" / "c.exr").string(), {gradient(4, 4)}, {}),
                 RuntimeError);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2);
}

TEST(image, outputs_are_checked_before_the_work) {
    const std::vector<std::string> endings = {".exr", ".png"};
    for (const char* path : {"new.exr", "new.png"})
        EXPECT_NO_THROW(check_output("-o", test::temporary(path), endings)) << path;
    for (const char* path : {"a.jpg", "a", "nowhere/a.exr"})
        EXPECT_THROW(check_output("-o", test::temporary(path), endings), InputError) << path;
    EXPECT_NO_THROW(check_output("--stats", test::temporary("a")));
    EXPECT_THROW(check_output("--stats", "/"), InputError);
}

TEST(image, auto_exposure_ignores_black) {
    Image image(10, 10, {"R", "G", "B"});
    EXPECT_EQ(auto_exposure(image), 1);
    for (int i = 0; i < 30; ++i) image.values[i] = 5;
    EXPECT_NEAR(auto_exposure(image) * 5, 0.7, 1e-5);
}

TEST(image, relmse_by_hand) {
    Image reference(2, 1, {"R", "G", "B"});
    reference.values = {1, 1, 1, 3, 3, 3};  // mean luminance 2: scaled to 0.25 and 0.75
    Image image = reference;
    EXPECT_EQ(compare_images(image, reference, "a", "b").relmse, 0);
    image.values[0] = 2;  // one value of six is off by 0.25 when scaled
    const Difference d = compare_images(image, reference, "a", "b");
    EXPECT_NEAR(d.relmse, 0.25 * 0.25 / (0.25 * 0.25 + 0.01) / 6, 1e-9);
    EXPECT_NEAR(d.rmse, std::sqrt(1. / 6), 1e-9);
    EXPECT_NEAR(d.mape, 0.25 / 0.26 / 6, 1e-9);
    EXPECT_NEAR(d.bias, 0.2126 / 4, 1e-9);
    EXPECT_NEAR(d.pixels[0], 2 * d.relmse, 1e-7);
    EXPECT_EQ(d.pixels[1], 0);
    image.values[5] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(compare_images(image, reference, "a", "b").bad, 1u);
    EXPECT_EQ(compare_images(image, reference, "a", "b").first_bad, 5u);
    EXPECT_EQ(place_of_value(image, 5), "pixel 1, 0, channel B");
    EXPECT_THROW((void)compare_images(reference, image, "a", "b"), InputError);
    EXPECT_THROW((void)compare_images(gradient(3, 1), reference, "a", "b"), InputError);
}

TEST(image, error_of_the_worst_pixels) {
    Image reference(100, 20, {"R", "G", "B"});
    std::ranges::fill(reference.values, 1.f);
    Image image = reference;
    // 2000 pixels: of an error of 100, two have 20 each, the next 18 have 2 each.
    for (int i = 0; i < 2000; ++i) {
        const double error = i < 2 ? 20 : i < 20 ? 2 : 24. / 1980;
        for (int c = 0; c < 3; ++c)
            image.values[3 * (7 * i % 2000) + c] = 1 + static_cast<float>(std::sqrt(error));
    }
    const Difference d = compare_images(image, reference, "a", "b");
    EXPECT_NEAR(d.worst_thousandth, 0.4, 1e-4);
    EXPECT_NEAR(d.worst_hundredth, 0.76, 1e-4);
    EXPECT_EQ(compare_images(reference, reference, "a", "b").worst_hundredth, 0);
}

// Black where there is no error, the scale's other end where it is large; small images are
// magnified.
TEST(image, error_picture) {
    ErrorPanel panel{"a", 4, 2, std::vector<float>(8)};
    panel.errors[5] = 1000;
    const Image picture = draw_error_picture({panel, panel});
    EXPECT_EQ(picture.width, 3 * 16 + 2 * 256u);
    const auto colors = error_colors();
    const auto expect_color = [&](unsigned x, unsigned y, std::size_t entry) {
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(picture.at(x, y)[c],
                        linear_from_srgb(static_cast<float>(colors[entry][c]) / 255), 1e-6)
                << x << " " << y;
    };
    const unsigned top = 16 + 20;
    for (const unsigned left : {16, 2 * 16 + 256}) {
        expect_color(left, top, 0);
        expect_color(left + 64, top + 64, 255);
        expect_color(left + 127, top + 127, 255);
        expect_color(left + 128, top + 127, 0);
    }
    EXPECT_LT(colors[0][0] + colors[0][1] + colors[0][2], 20);
    EXPECT_GT(colors[255][0] + colors[255][1] + colors[255][2], 550);
}

}  // namespace manylight
