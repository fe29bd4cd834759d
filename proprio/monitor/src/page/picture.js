// Pictures of arm and plots, as SVG and PNG.

import { drawArm } from './arm.js';
import { SECOND, drawPlot } from './plot.js';
import { SvgContext } from './export.js';

/** Pixels of a PNG for each pixel of the page. */
const RATIO = 2;
const MARGIN = 8;
const LINE = 18;

/**
 * The picture of what is seen: `head` are lines of text above all, `parts` have a title, a size, `draw(c, width, height)` and a
 * legend of names, colours and values.
 */
class Picture {
  constructor(head, parts, colours) {
    Object.assign(this, { head, parts, colours });
    this.width = Math.max(...parts.map(({ width }) => width));
    for (const part of parts) part.rows = rows(part.legend, this.width - 2 * MARGIN);
    const heights = parts.map(({ height, rows: { length } }) => LINE * (1 + length) + height + MARGIN);
    this.height = MARGIN + LINE * head.length + heights.reduce((sum, height) => sum + height, 0);
  }

  /** Draws it; `at(x, y, draw)` draws with the origin at this point. */
  draw(c, at) {
    let y = MARGIN;
    this.head.forEach((line, i) => {
      at(MARGIN, y, () => this.text(c, line, i ? 'normal' : 'bold'));
      y += LINE;
    });
    for (const part of this.parts) {
      at(MARGIN, y, () => this.text(c, part.title, 'bold'));
      y += LINE;
      for (const row of part.rows) {
        at(MARGIN, y, () => row.forEach((entry) => this.entry(c, entry)));
        y += LINE;
      }
      at(0, y, () => part.draw(c, part.width, part.height));
      y += part.height + MARGIN;
    }
  }

  text(c, line, weight) {
    Object.assign(c, { fillStyle: this.colours.ink, font: `${weight === 'bold' ? 13 : 12}px ${this.colours.font}`, textAlign: 'left', textBaseline: 'top' });
    c.fillText(line, 0, 0);
  }

  entry(c, { x, name, value, colour, isSecond }) {
    const { series, ink, font } = this.colours;
    Object.assign(c, { strokeStyle: series[colour % series.length], lineWidth: 4, lineCap: 'butt', globalAlpha: isSecond ? SECOND : 1 });
    c.beginPath();
    c.moveTo(x, 6);
    c.lineTo(x + 14, 6);
    c.stroke();
    Object.assign(c, { globalAlpha: 1, fillStyle: ink, font: `12px ${font}`, textAlign: 'left', textBaseline: 'top' });
    c.fillText(`${name} ${value}`, x + 18, 0);
  }
}

/** Entries of a legend in rows of this width, each with its place. */
function rows(legend, width) {
  const found = [];
  let x = Infinity;
  for (const entry of legend) {
    const length = 34 + 7 * (entry.name.length + entry.value.length + 1);
    if (x + length > width) {
      x = 0;
      found.push([]);
    }
    found.at(-1).push({ ...entry, x });
    x += length;
  }
  return found;
}

/** The picture of an arm and of plots. `size`: width and height of a canvas of the page. */
export function picture({ head, arm, armTitle, armSize, figures, row, colours }) {
  const size = ({ clientWidth: width, clientHeight: height }) => ({ width, height });
  const parts = [{ title: armTitle, ...size(armSize), legend: [], draw: (c, w, h) => drawArm(c, w, h, arm) }];
  for (const figure of figures.figures) {
    const spec = figures.spec(figure);
    parts.push({ title: figure.title, ...size(figure.canvas), legend: figures.legend(figure, row), draw: (c, w, h) => drawPlot(c, w, h, spec) });
  }
  return new Picture(head, parts, colours);
}

/** The picture as the text of an SVG file. */
export function toSvg(drawn) {
  const c = new SvgContext();
  drawn.draw(c, (x, y, draw) => {
    c.group(x, y);
    draw();
    c.endGroup();
  });
  return c.text(drawn.width, drawn.height, drawn.colours.paper);
}

/** The picture as a PNG file. */
export function toPng(drawn) {
  const canvas = Object.assign(document.createElement('canvas'), { width: RATIO * drawn.width, height: RATIO * drawn.height });
  const c = canvas.getContext('2d');
  c.scale(RATIO, RATIO);
  c.fillStyle = drawn.colours.paper;
  c.fillRect(0, 0, drawn.width, drawn.height);
  drawn.draw(c, (x, y, draw) => {
    c.save();
    c.translate(x, y);
    draw();
    c.restore();
  });
  return new Promise((done) => canvas.toBlob(done, 'image/png'));
}
