// Energies as text: measures with weights, such as `bending+0.3*variation(chord)`.

export interface Term {
  weight: number;
  measure: string;
  /** What stands in parentheses, without them. */
  arguments: string;
}

const TERM = /^\s*(?:([0-9.eE-]+)\s*\*\s*)?([a-z]+)\s*(?:\((.*)\))?\s*$/;

/** The terms of a text; none where it is not such a sum. */
export function terms(text: string): Term[] | undefined {
  const found: Term[] = [];
  for (const part of summands(text)) {
    const match = TERM.exec(part);
    const weight = Number(match?.[1] ?? 1);
    if (!match || !Number.isFinite(weight)) return undefined;
    found.push({ weight, measure: match[2] ?? "", arguments: match[3] ?? "" });
  }
  return found;
}

/** The text of terms. */
export function energyText(sum: readonly Term[]): string {
  const text = ({ weight, measure, arguments: inner }: Term): string =>
    `${weight === 1 ? "" : `${weight}*`}${measure}${inner ? `(${inner})` : ""}`;
  return sum.map(text).join("+");
}

/** Parts between the `+` signs that stand in no parentheses and follow no exponent. */
function summands(text: string): string[] {
  const parts = [""];
  let depth = 0;
  for (const letter of text) {
    depth += letter === "(" ? 1 : letter === ")" ? -1 : 0;
    if (letter === "+" && depth === 0) parts.push("");
    else parts[parts.length - 1] += letter;
  }
  return parts;
}
