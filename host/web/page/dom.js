// Elements of the page.

export const find = (id) => document.getElementById(id);

/** Writes a text, unless it is there already. */
export function write(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

/** A new element with a text. */
export function made(name, text = "", properties = {}) {
  return Object.assign(document.createElement(name), { textContent: text, ...properties });
}

/** A new button; `onclick` is what it does. */
export const button = (text, onclick) => made("button", text, { type: "button", onclick });
