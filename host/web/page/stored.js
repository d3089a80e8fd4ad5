// What the browser keeps for this page. Where site data are blocked it keeps nothing, and the page works without.

/** Stores: for good, and until this tab is closed. */
const STORES = { always: () => localStorage, tab: () => sessionStorage };

export function kept(store, key) {
  try {
    return STORES[store]().getItem(key);
  } catch {
    return null;
  }
}

export function keep(store, key, value) {
  try {
    STORES[store]().setItem(key, value);
  } catch {
    // Blocked: the next page does not know it.
  }
}
