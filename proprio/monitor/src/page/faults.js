// Faults of board and sensors, in one sentence.

/** States of sensors whose readings are used. */
const USED = { Slow: 'slow', Intermittent: 'with gaps' };

const count = (number, what) => `${number} ${what}${number === 1 ? '' : 's'}`;

/** `sensors`: name and state of each, in the order of the list. */
export function faults(status, sensors) {
  const found = [];
  const lost = sensors.filter(({ state }) => state && state !== 'Ok' && state !== 'NotWired' && !USED[state]);
  const weak = sensors.filter(({ state }) => USED[state]);
  if (lost.length) found.push(`${count(lost.length, 'sensor')} lost: ${lost.map(({ name }) => name).join(', ')}`);
  if (weak.length) found.push(`${count(weak.length, 'sensor')} unreliable: ${weak.map(({ name, state }) => `${name} ${USED[state]}`).join(', ')}`);
  if (status?.waiting) found.push(status.waiting);
  if (status?.port && !status.answers) found.push('the board does not answer requests');
  if (status?.offers_table) found.push('the board has another table');
  if (status?.recording?.failed) found.push(`recording failed: ${status.recording.failed}`);
  return found.join('; ');
}
