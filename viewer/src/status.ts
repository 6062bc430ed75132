import type { RunState } from './api';

export interface Chip {
  text: string;
  kind: 'live' | 'good' | 'bad' | 'plain';
  detail: string;
}

// Why the state could not be read: `taut view` does not answer, or it says what is wrong in the folder.
export interface Trouble {
  kind: 'gone' | 'unreadable';
  message: string;
}

// What is said about the run in the head of the page.
export function statusChip(state: RunState | null, trouble: Trouble | null): Chip {
  if (trouble?.kind === 'unreadable') return { text: 'Unreadable', kind: 'bad', detail: trouble.message };
  if (trouble) return { text: 'Disconnected', kind: 'bad', detail: '`taut view` has ended, or does not answer; start it again and reload this page. What is loaded can still be played.' };
  if (!state) return { text: 'Loading', kind: 'plain', detail: '' };
  switch (state.status) {
    case 'running':
      return { text: 'Running', kind: 'live', detail: 'New frames appear as they are computed' };
    case 'starting':
      return { text: 'Starting', kind: 'live', detail: '' };
    case 'finished':
      return { text: 'Finished', kind: 'good', detail: '' };
    case 'interrupted':
      return { text: 'Interrupted', kind: 'plain', detail: `Go on with: taut resume ${state.folder}` };
    case 'failed':
      return { text: 'Failed', kind: 'bad', detail: state.message };
    case 'crashed':
      return { text: 'Killed', kind: 'bad', detail: `${state.message}. Go on with: taut resume ${state.folder}` };
    case 'empty':
      return { text: 'Empty', kind: 'plain', detail: '' };
  }
}

// What stands in place of the cloth while there is none.
export function emptyMessage(state: RunState): string {
  switch (state.status) {
    case 'empty':
      return `${state.folder} holds no result yet.\nStart one with:  taut run SCENE.toml --out ${state.folder}\nIt will appear here.`;
    case 'starting':
    case 'running':
      return 'The simulation starts; its first frame will appear here.';
    default:
      return `${state.folder} holds no frame. ${state.message}`;
  }
}
