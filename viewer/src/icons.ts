const icon = (path: string) => `<svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true"><path d="${path}" fill="currentColor"/></svg>`;

export const icons = {
  play: icon('M4 2.5v11l9-5.5z'),
  pause: icon('M4 2.5h3v11H4zM9 2.5h3v11H9z'),
  back: icon('M11.5 3v10L5 8zM3.5 3H5v10H3.5z'),
  forward: icon('M4.5 3v10L11 8zM11 3h1.5v10H11z'),
};
