"""What a page shows: its view, and the images in its panels."""
import base64

# Colours of a picture of the view, drawn small: an empty one has two or three.
COUNT_COLOURS = """
(async () => {
  const image = new Image();
  image.src = "data:image/png;base64,%s";
  await image.decode();
  const area = document.getElementById("view").getBoundingClientRect();
  const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
  const context = canvas.getContext("2d");
  context.drawImage(image, area.left, area.top, area.width, area.height, 0, 0, 64, 64);
  const data = context.getImageData(0, 0, 64, 64).data, colours = new Set();
  for (let i = 0; i < data.length; i += 4) colours.add((data[i] >> 3) * 1024 + (data[i + 1] >> 3) * 32 + (data[i + 2] >> 3));
  return colours.size;
})()
"""
LEAST_COLOURS = 40  # a robot with its shades has hundreds

BYTES_OF_IMAGE = """
(async () => {
  const answer = await fetch(document.querySelector("#images img").src).catch(() => null); // the next image has come
  const bytes = answer ? new Uint8Array(await answer.arrayBuffer()) : [];
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));
})()
"""


def colours_of_view(browser):
    """Of the picture that is drawn next but one."""
    browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return browser.run(COUNT_COLOURS % base64.b64encode(browser.screenshot()).decode())


def without_exif(png):
    """A picture without the focal length of its camera, which files have and pages have not."""
    at = png.find(b"eXIf") - 4  # the length of its content comes first
    return png if at < 0 else png[:at] + png[at + 12 + int.from_bytes(png[at:at + 4], "big"):]


def panel_bytes(browser):
    """Of the first image of colour."""
    return base64.b64decode(browser.run(BYTES_OF_IMAGE))
