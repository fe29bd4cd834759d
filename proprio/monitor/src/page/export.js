// Export of the visible data to files.

import { visible } from './plot.js';

/** Saves a text or other content as a file of the browser. */
export function save(name, type, content) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** The rows between two times, as CSV: an empty cell where there is no value. */
export function csv(store, from, to, limit) {
  const [first, last] = visible(store, from, to, limit);
  const lines = [['time_s', ...store.names].join(',')];
  const cell = (value) => (Number.isNaN(value) ? '' : String(Math.round(value * 1e4) / 1e4));
  for (let i = first; i < last; i++) {
    if (store.times[i] < from || store.times[i] > to) continue;
    lines.push([String(Math.round(store.times[i] * 1e6) / 1e6), ...store.columns.map((column) => cell(column[i]))].join(','));
  }
  return lines.join('\n') + '\n';
}

/** The part of a canvas's context that this page uses, for an SVG. */
export class SvgContext {
  constructor() {
    Object.assign(this, { strokeStyle: '#000', fillStyle: '#000', lineWidth: 1, lineCap: 'butt', lineJoin: 'miter' });
    Object.assign(this, { globalAlpha: 1, font: '12px sans-serif', textAlign: 'left', textBaseline: 'alphabetic' });
    this.parts = [];
    this.path = '';
    this.dash = [];
    this.clips = 0;
  }

  /** Begins a group with its corner at this point. */
  group(x, y) { this.parts.push(`<g transform="translate(${x} ${y})">`); }
  endGroup() { this.parts.push('</g>'); }

  beginPath() { this.path = ''; }
  moveTo(x, y) { this.path += `M${number(x)} ${number(y)}`; }
  lineTo(x, y) { this.path += `L${number(x)} ${number(y)}`; }
  rect(x, y, w, h) { this.path += `M${number(x)} ${number(y)}h${number(w)}v${number(h)}h${number(-w)}z`; }
  setLineDash(dash) { this.dash = dash; }

  /** Whole ellipses only. */
  ellipse(x, y, a, b, turn) {
    const [dx, dy] = [a * Math.cos(turn), a * Math.sin(turn)], degrees = (turn * 180) / Math.PI;
    const arc = (sign) => `A${number(a)} ${number(b)} ${number(degrees)} 0 1 ${number(x + sign * dx)} ${number(y + sign * dy)}`;
    this.path += `M${number(x - dx)} ${number(y - dy)}${arc(1)}${arc(-1)}`;
  }

  stroke() {
    const dash = this.dash.length ? ` stroke-dasharray="${this.dash.join(' ')}"` : '';
    const alpha = this.globalAlpha < 1 ? ` stroke-opacity="${this.globalAlpha}"` : '';
    const ends = ` stroke-linecap="${this.lineCap}" stroke-linejoin="${this.lineJoin}"`;
    const style = `fill="none" stroke="${this.strokeStyle}" stroke-width="${number(this.lineWidth)}"`;
    this.parts.push(`<path d="${this.path}" ${style}${ends}${dash}${alpha}/>`);
  }

  save() { this.depth = this.clips; }
  clip() {
    this.clips++;
    this.parts.push(`<clipPath id="clip${this.clips}"><path d="${this.path}"/></clipPath><g clip-path="url(#clip${this.clips})">`);
  }
  restore() { if (this.clips > this.depth) this.parts.push('</g>'); }

  fillText(text, x, y) {
    const [size, family] = this.font.split(/px (.*)/);
    const anchor = { left: 'start', center: 'middle', right: 'end' }[this.textAlign];
    const baseline = { top: 'hanging', middle: 'central', alphabetic: 'auto' }[this.textBaseline];
    const place = `x="${number(x)}" y="${number(y)}" text-anchor="${anchor}" dominant-baseline="${baseline}"`;
    this.parts.push(`<text ${place} font-size="${size}" font-family="${escape(family)}" fill="${this.fillStyle}">${escape(text)}</text>`);
  }

  /** The whole file. */
  text(width, height, paper) {
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">`
      + `<rect width="100%" height="100%" fill="${paper}"/>${this.parts.join('\n')}</svg>\n`;
  }
}

const number = (value) => String(Math.round(value * 100) / 100);
const escape = (text) => text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
