/** Does the work when called; what is called for in the meantime is done once more, at the end. */
export function latest(work: () => Promise<unknown>): () => Promise<void> {
  let busy = false;
  let again = false;
  return async () => {
    again = true;
    if (busy) return;
    busy = true;
    while (again) {
      again = false;
      await work();
    }
    busy = false;
  };
}
