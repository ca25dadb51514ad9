// Small things about values of documents and numbers for people.
export const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
export const short = (x) => (x === null || x === undefined ? "none" : String(Math.abs(x) < 5e-4 ? 0 : Number(Number(x).toPrecision(3))));
