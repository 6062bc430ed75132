import assert from 'node:assert/strict';
import { afterEach, test } from 'node:test';
import { StatsFollower, StatsTable } from '../../src/stats';

const keep = ['time', 'iterations', 'bound_iterations'];
const text = 'step,time,solver,iterations,bound_iterations\n1,0.005,core_fast,7,12\n2,0.01,core_fast,9,\n';

test('columns by name; what is empty or no number is null', () => {
  const table = new StatsTable([...keep, 'solver']);
  table.append(text + '3,nan,upcg,inf,3\r\n');
  assert.equal(table.rows, 3);
  assert.deepEqual(table.column('time'), [0.005, 0.01, null]);
  assert.deepEqual(table.column('iterations'), [7, 9, null]);
  assert.deepEqual(table.column('bound_iterations'), [12, null, 3]);
  assert.deepEqual(table.column('solver'), [null, null, null]);
  assert.deepEqual(table.column('step'), []); // not kept
});

test('rows may come in any portions of whole lines', () => {
  const table = new StatsTable(keep);
  for (const line of text.split(/(?<=\n)/)) table.append(line);
  assert.deepEqual(table.column('iterations'), [7, 9]);
});

test('the row at a time, in spite of rounding', () => {
  const table = new StatsTable(keep);
  table.append('step,time,iterations\n' + Array.from({ length: 1000 }, (_, k) => `${k + 1},${((k + 1) / 300).toPrecision(9)},${k}\n`).join(''));
  assert.equal(table.rowAt(0), -1);
  for (const k of [0, 1, 2, 498, 998, 999]) assert.equal(table.rowAt((k + 1) / 300), k);
  assert.equal(table.rowAt(1.5 / 300), 0);
  assert.equal(table.rowAt(1e9), 999);
});

// A server with a file that grows, and may be replaced.
const realFetch = globalThis.fetch;
afterEach(() => (globalThis.fetch = realFetch));
function serve(file: { text: string; name: string }) {
  const asked: string[] = [];
  globalThis.fetch = (async (path: string) => {
    asked.push(path);
    return new Response(file.text.slice(Number(path.split('from=')[1])), { headers: { 'Taut-Stats': file.name } });
  }) as typeof fetch;
  return asked;
}

test('a growing file is read once, and a new one from its start', async () => {
  const file = { text, name: 'a' };
  const asked = serve(file);
  const follower = new StatsFollower(keep);
  assert.equal(await follower.update(), true);
  assert.equal(await follower.update(), false);
  file.text += '3,0.015,core_fast,5,12\n';
  assert.equal(await follower.update(), true);
  assert.deepEqual(follower.table.column('iterations'), [7, 9, 5]);
  assert.deepEqual(asked, ['api/stats?from=0', `api/stats?from=${text.length}`, `api/stats?from=${text.length}`]);
  // A resumed run: fewer rows, then others.
  Object.assign(file, { text: text.replace(',9,', ',4,') + '3,0.015,mpcg,6,\n4,0.02,mpcg,8,\n', name: 'b' });
  assert.equal(await follower.update(), true);
  assert.deepEqual(follower.table.column('iterations'), [7, 4, 6, 8]);
});
