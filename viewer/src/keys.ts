export type KeyActions = Record<string, (event: KeyboardEvent) => unknown>;

// Keys act wherever the focus is, except where they mean something there: text and choices, the space bar on a button, arrows on the scrubber.
export function bindKeys(actions: KeyActions) {
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target as HTMLElement;
    // A dialog that has just closed may still have the focus.
    if (target.closest('dialog')?.open && event.key !== '?') return;
    if (target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement) return;
    if (target instanceof HTMLButtonElement && (event.key === ' ' || event.key === 'Enter')) return;
    if (target instanceof HTMLInputElement && /^(Arrow|Home|End|Page)/.test(event.key) && !event.shiftKey) return;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
