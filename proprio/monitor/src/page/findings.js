// Findings of the session check.

/** A box with a list of the findings, which is hidden without any. */
export class FindingList {
  constructor(section) {
    this.section = section;
    this.list = section.querySelector('ul');
    this.shown = '';
  }

  show(findings) {
    const shown = findings.join('\n');
    if (shown === this.shown) return;
    this.shown = shown;
    this.section.hidden = !findings.length;
    this.list.replaceChildren(...findings.map((finding) => Object.assign(document.createElement('li'), { textContent: finding })));
  }
}
