/** Values with one more before each break, so that no line crosses it. */
export function broken<T>(breaks: number[], values: T[], between: (place: number) => T): T[] {
  if (!breaks.length) return values;
  const before = new Set(breaks);
  return values.flatMap((value, i) => (before.has(i) ? [between(i), value] : [value]));
}
