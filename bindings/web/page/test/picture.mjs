/** @return handle in the page of the pixels of its picture (ImageData), as they are on the screen */
export async function pixelsOf(page) {
  const url = `data:image/png;base64,${(await page.locator('#picture canvas').screenshot()).toString('base64')}`;
  return page.evaluateHandle(async url => {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = new OffscreenCanvas(image.width, image.height), c = canvas.getContext('2d');
    c.drawImage(image, 0, 0);
    return c.getImageData(0, 0, image.width, image.height);
  }, url);
}
