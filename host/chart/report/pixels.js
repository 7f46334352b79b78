// SPDX-License-Identifier: MIT
// Images as linear values, their errors, and how both look.
"use strict";

// uris[0] is the reference, uris[i + 1] is chart.images[i].
const pictures = JSON.parse(element("images").textContent);
const pixelCount = pictures.width * pictures.height;

// A grey PNG holds five planes, one below another: R, G, B and exponent of Radiance's RGBE, and the
// signs of the three. Gives [3 * pixel + channel].
async function decode(uri) {
  const image = new Image();
  image.src = uri;
  await image.decode();
  const canvas = make("canvas", { width: image.width, height: image.height });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, image.width, image.height);
  const out = new Float32Array(3 * pixelCount);
  for (let i = 0; i < pixelCount; ++i) {
    const scale = 2 ** (data[4 * (3 * pixelCount + i)] - 136);
    const signs = data[4 * (4 * pixelCount + i)];
    for (let c = 0; c < 3; ++c)
      out[3 * i + c] = (signs & (1 << c) ? -scale : scale) * data[4 * (c * pixelCount + i)];
  }
  return out;
}

const decoded = new Map();
function pixelsOf(index) {
  if (!decoded.has(index)) decoded.set(index, decode(pictures.uris[index]));
  return decoded.get(index);
}

// Each pixel's part of the relMSE, as manylight compare defines it.
function errorsOf(pixels, reference) {
  let luminance = 0;
  for (let i = 0; i < pixelCount; ++i)
    luminance += 0.2126 * reference[3 * i] + 0.7152 * reference[3 * i + 1] + 0.0722 * reference[3 * i + 2];
  const scale = (0.5 * pixelCount) / luminance;
  const out = new Float32Array(pixelCount);
  for (let i = 0; i < pixels.length; ++i) {
    const r = scale * reference[i];
    const d = scale * pixels[i] - r;
    out[Math.floor(i / 3)] += (d * d) / (r * r + 0.01) / 3;
  }
  return out;
}

const srgbCodes = Uint8ClampedArray.from({ length: 8193 }, (_v, i) => {
  const v = i / 8192;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055));
});

const [leastError, largestError] = chart.error_scale;
const colorOfError = (error) => pictures.colors[
  Math.round(255 * Math.min(1, Math.max(0, Math.log(error / leastError) / Math.log(largestError / leastError))))] ?? pictures.colors[0];

// A canvas of an image, at a scale, or of its errors.
async function drawPicture(index, what, scale) {
  const pixels = await pixelsOf(index);
  const errors = what === "error" ? errorsOf(pixels, await pixelsOf(0)) : null;
  const canvas = make("canvas", { width: pictures.width, height: pictures.height });
  const context = canvas.getContext("2d");
  const out = context.createImageData(pictures.width, pictures.height);
  for (let i = 0; i < pixelCount; ++i) {
    const color = errors && colorOfError(errors[i]);
    for (let c = 0; c < 3; ++c)
      out.data[4 * i + c] = color ? color[c] : srgbCodes[Math.round(8192 * Math.min(1, Math.max(0, scale * pixels[3 * i + c])))];
    out.data[4 * i + 3] = 255;
  }
  context.putImageData(out, 0, 0);
  return canvas;
}
