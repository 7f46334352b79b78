// SPDX-License-Identifier: MIT
#include "stages/pdf.hpp"

namespace manylight {

Mixture mixture_of(const Shares& shares, const std::vector<Light>& lights) {
    double power = 0;
    for (const Light& light : lights) power += light.emission.w;
    return {shares.visible, shares.unshadowed, shares.power, static_cast<float>(power)};
}

PdfStage::PdfStage(Device& device, const DeviceScene& scene)
    : device_(device),
      light_count_(scene.light_count),
      scene_(scene.arguments),
      quantise_(device.kernel("pdf.cl", "pdf_quantise", {}, "pdf")),
      scan_(device.kernel("pdf.cl", "pdf_scan", {}, "pdf")),
      add_(device.kernel("pdf.cl", "pdf_add", {}, "pdf")) {}

void PdfStage::normalise(uint count, const Mixture& mixture, Matrix& matrix) {
    const uint chunks = chunk_count(matrix.light_count);
    Arguments arguments = scene_;
    arguments.set("cdf", matrix.values)
        .set("row_count", count)
        .set("totals", matrix.totals)
        .set("mixture", mixture)
        .set("chunks", chunks)
        .set("chunk_sums", matrix.chunk_widths);
    quantise_.launch(std::size_t{count} * chunks, arguments);
    if (chunks == 1) return;
    scan_.launch(count, arguments);
    add_.launch(std::size_t{count} * chunks, arguments);
}

Buffer<uint> PdfStage::of_powers(const Mixture& mixture) {
    Matrix row(device_, 1, light_count_);
    row.values.clear();
    row.totals.clear();
    normalise(1, mixture, row);
    return row.values;
}

}  // namespace manylight
