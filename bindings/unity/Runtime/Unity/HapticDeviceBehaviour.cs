#if UNITY_5_3_OR_NEWER
using UnityEngine;

namespace Palpate
{
    /// <summary>A device as a component, for the list of a PalpateOrgan. Derive from it for your own device.</summary>
    public abstract class HapticDeviceBehaviour : MonoBehaviour
    {
        /// <summary>Opens the device of a hand, on Unity's thread. The haptic loop then calls it on its own.</summary>
        public abstract IHapticDevice Open(Simulation simulation, int hand);
    }
}
#endif
